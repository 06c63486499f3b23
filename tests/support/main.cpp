// SPDX-License-Identifier: Apache-2.0
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>

#include "support/locale.h"
#include "support/skipped.h"

int main(int argc, char** argv) {
  if (!ibr::test::setTestLocale()) return 77;
  return ibr::test::exitCodeOf(Catch::Session().run(argc, argv));
}
