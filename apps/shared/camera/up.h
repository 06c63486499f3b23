// SPDX-License-Identifier: Apache-2.0
// Where up is, told by how photographs were held.
#pragma once

#include <optional>
#include <vector>

#include "ibr/camera.h"
#include "ibr/htm_model.h"
#include "ibr/renderer.h"

namespace ibr::app {

/// The mean of the cameras' y axes, unit; nullopt where there is none: no camera, or held in too many ways (the mean is
/// shorter than a tenth).
std::optional<glm::dvec3> upOf(const std::vector<Pose>& cameras);

std::vector<Pose> posesOf(const Scene& scene);
std::vector<Pose> posesOf(const HtmModel& model);

/// A guiding floor, as programs ask for one and pictures tell of it. World units.
struct FloorWish {
  double eyeHeight = 1;           // so far below the middle of the photographs; < 0: above it
  std::optional<double> spacing;  // of its lines, > 0; nullopt: half the eye height
};

/// The mean of the cameras' places; of at least one.
glm::dvec3 centreOf(const std::vector<Pose>& cameras);

/// Below `middle`, level with `up` (unit). Throws Error{invalidInput} where there is no spacing to be had.
Floor floorBelow(glm::dvec3 middle, glm::dvec3 up, const FloorWish& wish);

/// Level as the photographs were held. Throws Error{invalidInput} where they do not tell where up is, or where there is
/// no spacing to be had.
Floor floorBelow(const Scene& scene, const FloorWish& wish);

}  // namespace ibr::app
