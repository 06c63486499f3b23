// SPDX-License-Identifier: Apache-2.0
#include "image/half_float.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ibr {
namespace {

constexpr int kMantissaBits = 10, kSmallestExponent = -14;  // of normal numbers
constexpr std::uint16_t kSign = 0x8000, kInfinity = 0x7C00, kNan = 0x7E00;

}  // namespace

std::uint16_t toHalf(float value) noexcept {
  const std::uint16_t sign = std::signbit(value) ? kSign : 0;
  const double magnitude = std::abs(double(value));
  if (std::isnan(magnitude)) return sign | kNan;
  if (std::isinf(magnitude)) return sign | kInfinity;
  const int exponent = magnitude > 0 ? std::max(std::ilogb(magnitude), kSmallestExponent) : kSmallestExponent;
  // In units of the last place. The scaling is exact; nearbyint rounds ties to even.
  const int units = int(std::nearbyint(std::ldexp(std::min(magnitude, 65536.0), kMantissaBits - exponent)));
  // The implicit bit of a normal number adds one to the exponent field, as does a carry of the rounding.
  const int bits = ((exponent - kSmallestExponent) << kMantissaBits) + units;
  return std::uint16_t(sign | std::uint16_t(std::min(bits, int(kInfinity))));
}

float fromHalf(std::uint16_t half) noexcept {
  const int field = (half & kInfinity) >> kMantissaBits, mantissa = half & ((1 << kMantissaBits) - 1);
  float magnitude;
  if (field == kInfinity >> kMantissaBits)
    magnitude = mantissa == 0 ? std::numeric_limits<float>::infinity() : std::numeric_limits<float>::quiet_NaN();
  else if (field == 0)
    magnitude = std::ldexp(float(mantissa), kSmallestExponent - kMantissaBits);
  else
    magnitude = std::ldexp(float(mantissa + (1 << kMantissaBits)), field - 1 + kSmallestExponent - kMantissaBits);
  return half & kSign ? -magnitude : magnitude;
}

}  // namespace ibr
