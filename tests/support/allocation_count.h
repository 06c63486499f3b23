// SPDX-License-Identifier: Apache-2.0
// Counts heap allocations: allocation_count.cpp replaces operator new in a test program.
#pragma once

#include <cstddef>

namespace ibr::test {

/// Returns the number of calls of operator new on this thread so far.
std::size_t allocationCount();

}  // namespace ibr::test
