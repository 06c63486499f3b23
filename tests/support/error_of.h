// SPDX-License-Identifier: Apache-2.0
// Catches the Error that a call throws.
#pragma once

#include <catch2/catch.hpp>

#include "ibr/error.h"

namespace ibr::test {

template <class F>
Error errorOf(F&& f) {
  try {
    f();
  } catch (const Error& e) {
    return e;
  }
  FAIL("nothing was thrown");
  return Error(ErrorCode::io, "");
}

}  // namespace ibr::test
