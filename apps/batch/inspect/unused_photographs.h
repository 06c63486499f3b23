// SPDX-License-Identifier: Apache-2.0
// Photographs that no cell shows, for people and for scripts.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "ibr/scene.h"

namespace ibr::app {

/// A table, or a line where every photograph is used.
std::string unusedText(const std::vector<UnusedPhotograph>& unused);

nlohmann::ordered_json unusedJson(const std::vector<UnusedPhotograph>& unused);

}  // namespace ibr::app
