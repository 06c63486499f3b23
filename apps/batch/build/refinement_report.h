// SPDX-License-Identifier: Apache-2.0
// What refining poses came to, in words and as JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "ibr/pose_refinement.h"

namespace ibr::app {

std::string text(const PoseRefinement& refinement);  // lines
nlohmann::ordered_json json(const PoseRefinement& refinement);

}  // namespace ibr::app
