// SPDX-License-Identifier: Apache-2.0
// Results of pose refinement, as text and as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "ibr/author/pose_refinement.h"

namespace ibr::app {

std::string text(const PoseRefinement& refinement);  // several lines
nlohmann::ordered_json json(const PoseRefinement& refinement);

}  // namespace ibr::app
