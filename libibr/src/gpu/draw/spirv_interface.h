// SPDX-License-Identifier: Apache-2.0
// A shader's interface to its pipeline, read from SPIR-V (SPIR-V specification 1.5, §2.3 and §3).
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <string>

namespace ibr {

struct SpirvVariable {
  std::string type;  // equal texts: same kind, dimensions, format and size; names do not count
  std::string name;  // from the source, for messages; may be empty
  bool operator==(const SpirvVariable& other) const { return type == other.type; }
};

struct SpirvInterface {
  using InterfaceSlot = std::array<std::uint32_t, 2>;

  std::uint32_t stage = 0;  // SPIR-V execution model: 0 vertex, 4 fragment, 5 compute
  std::string entryPoint;
  std::array<std::uint32_t, 3> workgroup{};  // 0 except for compute shaders
  std::uint64_t pushConstantBytes = 0;
  std::map<InterfaceSlot, SpirvVariable> bindings;         // by set and binding
  std::map<InterfaceSlot, SpirvVariable> inputs, outputs;  // by location and component; without built-ins
  std::map<InterfaceSlot, SpirvVariable> constants;        // specialisation constants, by id and 0
  std::set<std::uint32_t> capabilities;
};

/// Reads a module with one entry point. Throws Error{invalidInput} with the malformed word, and for modules with
/// several entry points. The words are untrusted; irrelevant instructions are skipped by their length.
SpirvInterface spirvInterface(std::span<const std::uint32_t> words);

/// Reasons why `other` cannot replace `own` in pipelines made for `own`, one per line; empty if it can. The replacement
/// must have the same stage, entry point, workgroup, inputs, outputs and specialisation constants. It must have no
/// other bindings, at most as many bytes of push constants, and no additional device features.
std::string interfaceMismatch(const SpirvInterface& own, const SpirvInterface& other);

}  // namespace ibr
