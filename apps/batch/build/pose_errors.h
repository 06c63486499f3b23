// SPDX-License-Identifier: Apache-2.0
// Errors of a model's poses against another model of the same photographs.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "ibr/author/poses.h"

namespace ibr::app {

struct PoseErrors {
  std::size_t photographs = 0;               // in both models, pinholes only
  double rotationPx = 0, maxRotationPx = 0;  // rotation × focal length, px: root mean square, and maximum
  double shift = 0, maxShift = 0;            // of positions, units of the truth's world: root mean square, and maximum
  double focalFactor = 1;                    // mean ratio of the focal lengths to the truth's
};

/// Compares after the similarity that aligns the model with the truth: origin, orientation and scale of a world are no
/// errors. Photographs are matched by name.
PoseErrors poseErrors(const PosedModel& model, const PosedModel& truth);

nlohmann::ordered_json json(const PoseErrors& errors);
std::string text(const PoseErrors& errors);

}  // namespace ibr::app
