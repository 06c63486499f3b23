// SPDX-License-Identifier: Apache-2.0
// How far poses are off those of another model of the same photographs.
#pragma once

#include <nlohmann/json.hpp>

#include "ibr/author.h"

namespace ibr::app {

struct PoseErrors {
  std::size_t photographs = 0;        // that both models have, all pinholes
  double turnPx = 0, mostTurnPx = 0;  // rotation × focal length: root mean square, and the largest
  double shift = 0, mostShift = 0;    // of positions, units of the truth's world
  double focalFactor = 1;             // mean, of focal lengths to the truth's
};

/// After the similarity that brings the model closest to the truth: where a world lies and its scale are no errors.
/// Photographs are known by their names.
PoseErrors poseErrors(const PosedModel& model, const PosedModel& truth);

nlohmann::ordered_json json(const PoseErrors& errors);
std::string text(const PoseErrors& errors);

}  // namespace ibr::app
