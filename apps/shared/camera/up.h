// SPDX-License-Identifier: Apache-2.0
// Up direction of the world, from the orientation of the photographs.
#pragma once

#include <optional>
#include <vector>

#include "ibr/camera.h"
#include "ibr/frame_plan.h"
#include "ibr/htm_model.h"

namespace ibr::app {

/// Returns the unit mean of the cameras' y axes. nullopt: there are no cameras, or the axes disagree (mean shorter than
/// 0.1).
std::optional<glm::dvec3> upOf(const std::vector<Pose>& cameras);

std::vector<Pose> posesOf(const Scene& scene);
std::vector<Pose> posesOf(const HtmModel& model);

/// Options of the guiding floor, from the command line or an image's record. World units.
struct FloorOptions {
  double eyeHeight = 1;           // depth below the centre of the photographs; < 0: above
  std::optional<double> spacing;  // distance between lines, > 0; nullopt: half the eye height
};

/// Returns the mean position of at least one camera.
glm::dvec3 centreOf(const std::vector<Pose>& cameras);

/// Returns a floor below `middle`, orthogonal to `up` (unit). Throws Error{invalidInput} if the spacing is not above 0.
Floor floorBelow(glm::dvec3 middle, glm::dvec3 up, const FloorOptions& options);

/// Returns a floor orthogonal to the photographs' up direction. Throws Error{invalidInput} if the photographs have no
/// common up direction, or if the spacing is not positive.
Floor floorBelow(const Scene& scene, const FloorOptions& options);

}  // namespace ibr::app
