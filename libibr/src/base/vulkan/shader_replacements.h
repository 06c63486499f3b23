// SPDX-License-Identifier: Apache-2.0
// Replacements of embedded shaders on one device ([T] §4.1.3). ShaderReloader writes them; all code that makes
// pipelines reads them.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "ibr/device.h"

namespace ibr {

struct ShaderReplacements {
  std::map<const std::uint32_t*, std::vector<std::uint32_t>> words;  // by the address of the embedded words
  std::uint64_t generation = 0;                                      // Device::shaderGeneration()

  std::span<const std::uint32_t> currentWords(std::span<const std::uint32_t> embedded) const noexcept {
    const auto found = words.find(embedded.data());
    return found == words.end() ? embedded : std::span<const std::uint32_t>(found->second);
  }
};

/// Replacements of the device; their address stays when the Device is moved.
ShaderReplacements& shaderReplacements(Device& device) noexcept;
const ShaderReplacements& shaderReplacements(const Device& device) noexcept;

}  // namespace ibr
