// SPDX-License-Identifier: Apache-2.0
// `ibr bench --matchers`: the matching methods in one table.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "shared/cli/context.h"

namespace ibr::app {

struct MatcherBench {
  std::string cases;     // file that readMatchCases reads
  std::string data;      // folder that its paths start from; empty: the file's own
  std::string pictures;  // folder for what each method makes of the members; empty: none
};

/// Prints the table; returns the same numbers. Throws Error.
nlohmann::ordered_json benchMatchers(const MatcherBench& bench, const Context& context);

}  // namespace ibr::app
