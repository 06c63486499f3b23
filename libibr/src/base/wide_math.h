// SPDX-License-Identifier: Apache-2.0
// Functions for loops that the compiler vectorises: no branches, arguments by value, always inlined.
#pragma once

namespace ibr {

/// std::min and std::max return references, which prevents vectorisation. If `a` is NaN, these return `b`.
[[gnu::always_inline]] inline float smaller(float a, float b) {
  return a < b ? a : b;
}
[[gnu::always_inline]] inline float larger(float a, float b) {
  return a > b ? a : b;
}

/// Arctangent of t, |t| <= 1, radians: Abramowitz and Stegun 4.4.49, error below 1e-7.
[[gnu::always_inline]] inline float arctangent(float t) {
  const float s = t * t;
  float r = 0.0028662257f;
  r = r * s - 0.0161657367f;
  r = r * s + 0.0429096138f;
  r = r * s - 0.0752896400f;
  r = r * s + 0.1065626393f;
  r = r * s - 0.1420889944f;
  r = r * s + 0.1999355085f;
  r = r * s - 0.3333314528f;
  return (r * s + 1) * t;
}

}  // namespace ibr
