// SPDX-License-Identifier: Apache-2.0
// Converts settings into command-line words, to pass settings from one program to another.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace ibr::app {

/// Returns the options for the "settings" object of a report or of an image's record. The object has a key for each
/// option: {"renderScale":0.5,"graph":true,"floor":null} gives --render-scale 0.5 --graph. Lists are joined by
/// commas; null, false and empty lists give no option, nor do settings of kMeasuredSettings with their default. Numbers
/// keep their last bit.
std::vector<std::string> settingArguments(const nlohmann::ordered_json& settings);

}  // namespace ibr::app
