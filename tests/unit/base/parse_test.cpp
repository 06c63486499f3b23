// SPDX-License-Identifier: Apache-2.0
#include "base/parse.h"

#include <catch2/catch.hpp>
#include <clocale>

using ibr::parseDouble;
using ibr::parseInt;

TEST_CASE("numbers are read whole or not at all") {
  CHECK(parseDouble("0.75") == 0.75);
  CHECK(parseDouble("+1e3") == 1000.0);
  CHECK(parseDouble("-.5") == -0.5);
  CHECK(parseInt("-42") == -42);
  for (const char* wrong : {"", " 1", "1 ", "1,5", "0x10", "nan", "inf", "1e999", "+-1", "--1", "1.2.3"}) {
    INFO(wrong);
    CHECK_FALSE(parseDouble(wrong));
  }
  for (const char* wrong : {"", "1.0", "9223372036854775808", "1e3", " 7"}) CHECK_FALSE(parseInt(wrong));
}

TEST_CASE("a locale with decimal commas changes nothing", "[locale]") {
  const char* const set =
      std::setlocale(LC_ALL, "de_DE.UTF-8");  // some systems lack this locale; the checks then repeat the ones above
  CHECK(parseDouble("0.75") == 0.75);
  CHECK_FALSE(parseDouble("0,75"));
  if (set) std::setlocale(LC_ALL, "C");
}
