// SPDX-License-Identifier: Apache-2.0
#include "shared/cli/near_name.h"

#include <array>
#include <catch2/catch.hpp>

namespace ibr::app {

using Names = std::array<std::string, 4>;

TEST_CASE("a misspelt name has the nearest name as suggestion, a name and an unlike word have none") {
  const Names names{"--max-size", "--mask", "--masks", "--fov"};
  for (const char* word : {"--max-szie", "--maxsize", "--max-sizes", "--mx-size", "--nax-sise"}) {
    INFO(word);
    CHECK(nearName(word, names) == "--max-size");
  }
  CHECK(nearName("--maks", names) == "--mask");  // two letters swapped, against one missing and one added
  CHECK(nearName("--foo", names) == "--fov");
  for (const char* word : {"--max-size", "--mask", "--bob", "--", "", "--memory", "--max"}) {
    INFO(word);
    CHECK(!nearName(word, names));
  }
  CHECK(!nearName("--max-size", {}));
}

}  // namespace ibr::app
