// SPDX-License-Identifier: Apache-2.0
// Photographs that no cell shows, as text and as JSON.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "ibr/scene.h"

namespace ibr::app {

/// Returns a table, or a line if every photograph is used.
std::string unusedText(const std::vector<UnusedPhotograph>& unused);

nlohmann::ordered_json unusedJson(const std::vector<UnusedPhotograph>& unused);

}  // namespace ibr::app
