// SPDX-License-Identifier: Apache-2.0
// What a shader demands of its pipeline, read from SPIR-V (SPIR-V specification 1.5, §2.3 and §3).
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <string>

namespace ibr {

struct SpirvVariable {
  std::string type;  // two of the same text have the same kind, dimensions, format and size; names play no part
  std::string name;  // as in the source, for people; may be empty
  bool operator==(const SpirvVariable& other) const { return type == other.type; }
};

struct SpirvInterface {
  using InterfaceSlot = std::array<std::uint32_t, 2>;

  std::uint32_t stage = 0;  // SPIR-V's execution model: 0 vertex, 4 fragment, 5 compute
  std::string entryPoint;
  std::array<std::uint32_t, 3> workgroup{};  // 0 but for compute shaders
  std::uint64_t pushConstantBytes = 0;
  std::map<InterfaceSlot, SpirvVariable> bindings;         // by set and binding
  std::map<InterfaceSlot, SpirvVariable> inputs, outputs;  // by location and component; without built-ins
  std::map<InterfaceSlot, SpirvVariable> constants;        // specialisation constants, by id and 0
  std::set<std::uint32_t> capabilities;
};

/// Of a module with one entry point. Throws Error{invalidInput} that names the word where it is malformed, and for
/// modules of several entry points. Words are untrusted; instructions that play no part are only measured.
SpirvInterface spirvInterface(std::span<const std::uint32_t> words);

/// Why `other` cannot take the place of `own` in pipelines made for it, a line each; empty: it can. It has the same
/// stage, entry point, workgroup, inputs, outputs and specialisation constants, no other bindings, at most as many
/// bytes of push constants, and needs no further feature of the device.
std::string interfaceMismatch(const SpirvInterface& own, const SpirvInterface& other);

}  // namespace ibr
