// SPDX-License-Identifier: Apache-2.0
// Replaces the main of ibr_test_support: skips the tests if no runtime is given.
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>
#include <cstdio>
#include <cstdlib>

#include "support/skipped.h"

int main(int argc, char** argv) {
  const auto given = [](const char* name) {
    const char* value = std::getenv(name);
    return value && *value;
  };
  if (!given("IBR_XR_RUNTIME")) {
    std::fprintf(stderr, "%s: IBR_XR_RUNTIME names no OpenXR runtime (tests/xr/runtime.sh makes one)\n",
                 given("IBR_REQUIRE_XR") ? "failed" : "skipped");
    return given("IBR_REQUIRE_XR") ? 1 : 77;
  }
  return ibr::test::exitCodeOf(Catch::Session().run(argc, argv));
}
