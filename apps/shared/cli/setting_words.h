// SPDX-License-Identifier: Apache-2.0
// Settings as words of a command line: the way from one program to another.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace ibr::app {

/// The options that bring about what a report or a picture's record says ("settings", an object with a key for each
/// option): {"renderScale":0.5,"graph":true,"floor":null} is --render-scale 0.5 --graph. Lists are joined by
/// commas; null, false and empty lists are what there is without the option. Numbers keep their last bit.
std::vector<std::string> settingWords(const nlohmann::ordered_json& settings);

}  // namespace ibr::app
