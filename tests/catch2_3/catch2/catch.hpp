// SPDX-License-Identifier: Apache-2.0
// Catch2 3 with the header and the names of Catch2 2, for which the tests are written: Debian 12 has Catch2 2.
#pragma once

#include <catch2/catch_all.hpp>
#include <string>

namespace Catch {

using Matchers::EndsWith;
using Matchers::Matches;
using Matchers::StartsWith;
using TestEventListenerBase = EventListenerBase;

inline Matchers::StringContainsMatcher Contains(const std::string& part) {
  return Matchers::ContainsSubstring(part);
}

}  // namespace Catch

using Catch::Approx;
