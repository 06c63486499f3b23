// SPDX-License-Identifier: Apache-2.0
// What stands in for embedded shaders on one device ([T] §4.1.3). Read by all that makes pipelines, written by
// ShaderReloader.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "ibr/device.h"

namespace ibr {

struct ShaderReplacements {
  std::map<const std::uint32_t*, std::vector<std::uint32_t>> words;  // by where the embedded words lie
  std::uint64_t generation = 0;                                      // Device::shaderGeneration()

  std::span<const std::uint32_t> inUse(std::span<const std::uint32_t> embedded) const noexcept {
    const auto found = words.find(embedded.data());
    return found == words.end() ? embedded : std::span<const std::uint32_t>(found->second);
  }
};

/// The device's own, which stays where it is when the Device is moved.
ShaderReplacements& shaderReplacements(Device& device) noexcept;
const ShaderReplacements& shaderReplacements(const Device& device) noexcept;

}  // namespace ibr
