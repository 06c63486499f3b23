// SPDX-License-Identifier: Apache-2.0
// Test cases that cannot run. A program that skips a case and has no failure exits with 77: CTest's code for "skipped".
#pragma once

#include <catch2/catch.hpp>
#include <cstdio>

namespace ibr::test {

inline int skippedCases = 0;

/// Records that the current test case cannot run; returns false.
inline bool skipCase(const char* why) {
  ++skippedCases;
  std::fprintf(stderr, "skipped: %s: %s\n", Catch::getResultCapture().getCurrentTestName().c_str(), why);
  return false;
}

/// Returns the exit code of a program whose test cases gave `result`.
inline int exitCodeOf(int result) {
  return result == 0 && skippedCases > 0 ? 77 : result;
}

}  // namespace ibr::test
