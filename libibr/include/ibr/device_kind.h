// SPDX-License-Identifier: Apache-2.0
// Kind of processor behind a Vulkan device. Presets depend on the kind.
#pragma once

#include <cstdint>

namespace ibr {

/// Kind of processor that runs a device's shaders.
enum class DeviceKind : std::uint8_t {
  software,  // VK_PHYSICAL_DEVICE_TYPE_CPU
  hardware,  // all other types
};

}  // namespace ibr
