// SPDX-License-Identifier: Apache-2.0
// Sets the locale in which a test program runs.
#pragma once

#include <clocale>
#include <cstdio>
#include <cstdlib>
#include <locale>
#include <stdexcept>
#include <string>

namespace ibr::test {

/// Sets the C and C++ locale to IBR_TEST_LOCALE, which must have a decimal comma: programs that link the library may do
/// so. An unset variable keeps the "C" locale. Returns false and prints a message if there is no such locale.
inline bool setTestLocale() {
  const char* name = std::getenv("IBR_TEST_LOCALE");
  if (!name || !*name) return true;
  char half[8] = "";
  try {
    std::locale::global(std::locale(name));
    std::snprintf(half, sizeof half, "%.1f", 0.5);
  } catch (const std::runtime_error&) {
  }
  const bool comma = std::string(half) == "0,5";
  if (!comma)
    std::fprintf(stderr, "skipped: there is no locale %s with a decimal comma (tests/run.sh creates it)\n", name);
  return comma;
}

}  // namespace ibr::test
