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

/// A guiding floor `eyeHeight` > 0 (world units) below the middle of the photographs, level as they were held. Throws
/// Error{invalidInput} where they do not tell where up is.
Floor floorBelow(const Scene& scene, double eyeHeight);

}  // namespace ibr::app
