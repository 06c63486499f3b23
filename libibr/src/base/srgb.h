// SPDX-License-Identifier: Apache-2.0
// The sRGB transfer function (IEC 61966-2-1) for values of 0 to 1.
#pragma once

#include <cmath>

namespace ibr {

inline double srgbToLinear(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}
inline double linearToSrgb(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

}  // namespace ibr
