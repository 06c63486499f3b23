// SPDX-License-Identifier: Apache-2.0
// Colours that targets of all formats and encodings may store of one 8-bit image.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "base/srgb.h"
#include "ibr/image.h"
#include "ibr/target.h"

namespace ibr::test {

/// Combinations with more than 8 bits a channel.
inline constexpr std::array<TargetFormat, 4> kWideFormats{{{VK_FORMAT_R16G16B16A16_SFLOAT, Encoding::display},
                                                           {VK_FORMAT_R16G16B16A16_SFLOAT, Encoding::linear},
                                                           {VK_FORMAT_A2B10G10R10_UNORM_PACK32, Encoding::display},
                                                           {VK_FORMAT_A2B10G10R10_UNORM_PACK32, Encoding::linear}}};

/// Largest error of a UNORM value, in its steps: Vulkan allows both neighbours of the exact value. Lavapipe rounds some
/// values to the further one.
inline constexpr double kRoundedSteps = 1;

/// Largest error of a stored value. `steps`: of a UNORM value from 0 to 1. A device may round half floats towards zero,
/// so their error is a unit in the last place.
inline double roundingOf(double value, VkFormat format, double steps) {
  if (format == VK_FORMAT_R16G16B16A16_SFLOAT) return std::ldexp(std::abs(value), -10) + std::ldexp(1.0, -24);
  return kRoundedSteps / steps;
}

inline double stored(double displayEncoded, Encoding encoding) {
  return encoding == Encoding::linear ? srgbToLinear(displayEncoded) : displayEncoded;
}

/// Returns the number of channels of `seen`, alpha included, that do not fit the 8-bit image. `levels`: error of its
/// colours, 8-bit levels; 0 where the drawn image has 8 bits and is stored as it is.
inline std::size_t wrongChannels(const ImageF& seen, const Image8& image, TargetFormat format, double levels) {
  constexpr double kArithmetic = 1e-5;  // of the shader's transfer function: Vulkan's bound of pow() is about 5e-6 here
  const bool has10Bits = format.format == VK_FORMAT_A2B10G10R10_UNORM_PACK32;
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < seen.values.size(); ++i) {
    const bool isAlpha = i % 4 == 3;
    const double level = image.values[i], error = isAlpha ? 0 : levels;
    const auto bound = [&](double at) {
      const double encoded = std::clamp(at / 255, 0.0, 1.0);
      return isAlpha ? encoded : stored(encoded, format.encoding);
    };
    const double low = bound(level - error), high = bound(level + error);
    const double rounding = roundingOf(high, format.format, !has10Bits ? 255 : isAlpha ? 3 : 1023) + kArithmetic;
    wrong += !(seen.values[i] >= low - rounding && seen.values[i] <= high + rounding);
  }
  return wrong;
}

}  // namespace ibr::test
