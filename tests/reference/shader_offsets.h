// SPDX-License-Identifier: Apache-2.0
// Reads the offsets of a struct's members from SPIR-V.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>

namespace ibr::test {

/// Offsets of a named struct's members, read from OpMemberDecorate of the module.
inline std::map<std::string, std::uint32_t> offsetsOf(std::span<const std::uint32_t> spirv, const std::string& name) {
  constexpr std::uint32_t kOpName = 5, kOpMemberName = 6, kOpMemberDecorate = 72, kOffset = 35;
  std::uint32_t type = 0;
  std::map<std::uint32_t, std::string> members;
  std::map<std::string, std::uint32_t> offsets;
  for (std::size_t at = 5; at < spirv.size(); at += spirv[at] >> 16) {
    const std::uint32_t* word = &spirv[at];
    const std::uint32_t operation = *word & 0xffff;
    if (operation == kOpName && name == reinterpret_cast<const char*>(word + 2) && type == 0) type = word[1];
    if (operation == kOpMemberName && word[1] == type) members[word[2]] = reinterpret_cast<const char*>(word + 3);
    if (operation == kOpMemberDecorate && word[1] == type && word[3] == kOffset) offsets[members[word[2]]] = word[4];
  }
  return offsets;
}

}  // namespace ibr::test
