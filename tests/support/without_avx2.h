// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include "base/wide.h"

namespace ibr::test {

/// Returns the result of `compute` without the loops' versions for AVX2 and FMA (base/wide.h).
template <class Compute>
auto withoutAvx2(Compute&& compute) {
  struct Restore {
    bool before = std::exchange(usesAvx2(), false);
    ~Restore() { usesAvx2() = before; }
  } restore;
  return compute();
}

}  // namespace ibr::test
