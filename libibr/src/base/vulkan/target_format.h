// SPDX-License-Identifier: Apache-2.0
// Formats of callers' colour targets: the supported combinations, and the values to write for them.
#pragma once

#include <glm/vec3.hpp>

#include "base/check.h"
#include "base/srgb.h"
#include "base/vulkan/format.h"
#include "ibr/target.h"

namespace ibr {

/// Returns the reason why no target may have the format; nullptr if targets may.
constexpr const char* targetFormatFault(TargetFormat format) noexcept {
  switch (format.format) {
    case VK_FORMAT_R8G8B8A8_UNORM:
    case VK_FORMAT_B8G8R8A8_UNORM:
      return format.encoding == Encoding::display ? nullptr : "8 bits are too coarse for Encoding::linear";
    case VK_FORMAT_R8G8B8A8_SRGB:
    case VK_FORMAT_B8G8R8A8_SRGB:
      return format.encoding == Encoding::display ? nullptr : "SRGB formats store display-encoded values";
    case VK_FORMAT_A2B10G10R10_UNORM_PACK32:
    case VK_FORMAT_R16G16B16A16_SFLOAT:
      return nullptr;
    default:
      return "targets are 8-bit RGBA or BGRA, A2B10G10R10 or RGBA16F";
  }
}

/// Throws Error{unsupported} in the name of `user` if no target may have the format.
inline void checkTargetFormat(const char* user, TargetFormat format) {
  if (const char* fault = targetFormatFault(format))
    fail(ErrorCode::unsupported, "{}: VkFormat {}: {}", user, int(format.format), fault);
}

constexpr TargetFormat formatOf(const Target& target) noexcept {
  return {target.format, target.encoding};
}

/// True if shaders and clears must write linear light: also for formats that encode it.
constexpr bool takesLinear(TargetFormat format) noexcept {
  return format.encoding == Encoding::linear || isSrgb(format.format);
}

/// Returns the value to write for a display-encoded colour.
inline glm::vec3 writtenColour(glm::vec3 colour, TargetFormat format) {
  if (takesLinear(format))
    for (int c = 0; c < 3; ++c) colour[c] = float(srgbToLinear(double(colour[c])));
  return colour;
}

}  // namespace ibr
