// SPDX-License-Identifier: Apache-2.0
// Counts file reads.
#pragma once

#include <fstream>
#include <string>

namespace ibr::test {

/// Returns the number of read() calls of this thread so far, those of this function included, as Linux counts them. Two
/// calls with nothing between them differ by the same number each time.
inline long readCount() {
  std::ifstream statistics("/proc/thread-self/io");
  std::string name;
  long value = 0;
  while (statistics >> name >> value)
    if (name == "syscr:") return value;
  return -1;  // the kernel does not count
}

}  // namespace ibr::test
