// SPDX-License-Identifier: Apache-2.0
// Command lines as JSON: `PROGRAM --describe`. libibr/docs/reference/main.py makes the pages of all commands, man pages
// and shell completion of it, so that these list what the programs accept.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string_view>

#include "shared/cli/cli_fwd.h"

namespace ibr::app {

inline constexpr std::string_view kDescribe = "--describe";

/// The options and arguments that the help of `app` lists, in this order, each with "names" (of an argument: its one
/// name), "argument", "flag", "type" (the word for a value), "description", "heading" and, where they apply,
/// "required", "repeated", "needs" and "excludes" (names).
nlohmann::ordered_json describeOptions(const CLI::App& app);

/// Exit codes of all programs: "code", "meaning".
nlohmann::ordered_json describeExitCodes();

/// Writes `json` to stdout.
void printDescription(const nlohmann::ordered_json& json);

}  // namespace ibr::app
