// SPDX-License-Identifier: Apache-2.0
#include "ibr/version.h"

#include <catch2/catch.hpp>
#include <string>

using namespace ibr;

TEST_CASE("the library's version is the headers' version") {
  CHECK(version() == std::to_string(IBR_VERSION_MAJOR) + "." + std::to_string(IBR_VERSION_MINOR) + "." +
                         std::to_string(IBR_VERSION_PATCH));
}

TEST_CASE("CMake reads the project's version from the headers") {
  CHECK(version() == IBR_TEST_PROJECT_VERSION);
}
