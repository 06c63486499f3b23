// SPDX-License-Identifier: Apache-2.0
// All shaders of libibr's layers, and how the build compiles them; written by cmake/IbrShaders.cmake.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace ibr {

struct EmbeddedShader {
  std::string_view file;  // below shaders/
  const std::span<const std::uint32_t>* words;
};

std::span<const EmbeddedShader> embeddedShaders() noexcept;
std::span<const std::string_view> shaderFlags() noexcept;

}  // namespace ibr
