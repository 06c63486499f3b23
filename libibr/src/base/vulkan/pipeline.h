// SPDX-License-Identifier: Apache-2.0
// Pipelines and their layouts. States that all passes share are fixed: no culling, one sample, dynamic viewport and
// scissor.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/vulkan/handle.h"
#include "ibr/device.h"

namespace ibr {

/// Values of specialisation constants, for all stages of a pipeline. Empty: the shaders' defaults.
struct Specialisation {
  std::span<const VkSpecializationMapEntry> entries;
  std::span<const std::byte> data;
};

/// Effect of a draw on the colours in the attachment. Only `replace` overwrites their alpha; `over` keeps it.
enum class Blending : std::uint8_t {
  replace,
  over,  // blended by the new colour's alpha
  add,   // colours are added; alpha is the maximum
};

struct GraphicsPipelineInfo {
  const char* name = "";
  std::span<const std::uint32_t> vertex, fragment;  // SPIR-V, entry point main; no fragment: depth only
  Specialisation specialisation;
  std::span<const VkVertexInputBindingDescription> bindings;
  std::span<const VkVertexInputAttributeDescription> attributes;
  VkPipelineLayout layout = VK_NULL_HANDLE;
  VkRenderPass renderPass = VK_NULL_HANDLE;    // subpass 0, one colour attachment; null: dynamic rendering
  std::span<const VkFormat> colourFormats;     // for dynamic rendering
  VkFormat depthFormat = VK_FORMAT_UNDEFINED;  // likewise; without colours depth is written, and tested with depthTest
  bool attachments = true;                     // false: dynamic rendering without any; fragments only store
  bool depthTest = false;                      // a fragment passes if its depth is less
  bool depthEqual = false;                     // it also passes if its depth is equal
  bool depthWrite = false;
  bool depthClamp = false;
  Blending blending = Blending::replace;
};

struct ComputePipelineInfo {
  const char* name = "";
  std::span<const std::uint32_t> shader;  // SPIR-V, entry point main
  Specialisation specialisation;
  VkPipelineLayout layout = VK_NULL_HANDLE;
};

/// Module of `spirv`, or of the words that replace `spirv` on this device (base/vulkan/shader_replacements.h). The
/// pipelines below use the same replacements.
ShaderModuleHandle shaderModule(const Device& device, std::span<const std::uint32_t> spirv);
PipelineHandle makeGraphicsPipeline(const Device& device, const GraphicsPipelineInfo& info);
PipelineHandle makeComputePipeline(const Device& device, const ComputePipelineInfo& info);

DescriptorSetLayoutHandle makeSetLayout(const Device& device, std::span<const VkDescriptorSetLayoutBinding> bindings);
PipelineLayoutHandle makePipelineLayout(const Device& device, std::span<const VkDescriptorSetLayout> sets,
                                        std::span<const VkPushConstantRange> pushConstants);

}  // namespace ibr
