// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "base/check.h"
#include "gpu/draw/spirv_interface.h"

namespace ibr {
namespace {

using Variables = std::map<SpirvInterface::InterfaceSlot, SpirvVariable>;

// `what` is a format string for the two numbers of a slot.
std::string mismatch(const char* what, const Variables& own, const Variables& other, bool all) {
  std::string text;
  const auto line = [&](const auto& variable, const std::string& how) {
    text += fmt::format(fmt::runtime(what), variable.first[0], variable.first[1]);
    text += fmt::format(" '{}' {}\n", variable.second.name, how);
  };
  for (const auto& variable : other) {
    const auto found = own.find(variable.first);
    if (found == own.end())
      line(variable, "is new: " + variable.second.type);
    else if (found->second.type != variable.second.type)
      line(variable, fmt::format("is {}, was {}", variable.second.type, found->second.type));
  }
  for (const auto& variable : own)
    if (all && !other.contains(variable.first)) line(variable, "is missing: " + variable.second.type);
  return text;
}

// Capabilities that need no feature: Vulkan 1.2, appendix "SPIR-V Environment".
bool always(std::uint32_t capability) {
  constexpr std::uint32_t kAlways[]{0, 1, 40, 43, 44, 46, 47, 50, 51};
  return std::ranges::find(kAlways, capability) != std::end(kAlways);
}

}  // namespace

std::string interfaceMismatch(const SpirvInterface& own, const SpirvInterface& other) {
  std::string text;
  if (other.stage != own.stage) text += fmt::format("the stage is {}, was {}\n", other.stage, own.stage);
  if (other.entryPoint != own.entryPoint)
    text += fmt::format("the entry point is '{}', was '{}'\n", other.entryPoint, own.entryPoint);
  if (other.workgroup != own.workgroup)
    text += fmt::format("the workgroup is {}x{}x{}, was {}x{}x{}\n", other.workgroup[0], other.workgroup[1],
                        other.workgroup[2], own.workgroup[0], own.workgroup[1], own.workgroup[2]);
  if (other.pushConstantBytes > own.pushConstantBytes)
    text += fmt::format("push constants have {} bytes, had {}\n", other.pushConstantBytes, own.pushConstantBytes);
  text += mismatch("set {}, binding {}:", own.bindings, other.bindings, false);
  text += mismatch("input at location {}, component {}:", own.inputs, other.inputs, true);
  text += mismatch("output at location {}, component {}:", own.outputs, other.outputs, true);
  text += mismatch("specialisation constant {}:", own.constants, other.constants, true);
  for (const std::uint32_t capability : other.capabilities)
    if (!own.capabilities.contains(capability) && !always(capability))
      text += fmt::format("SPIR-V capability {} is new\n", capability);
  if (!text.empty()) text.pop_back();
  return text;
}

}  // namespace ibr
