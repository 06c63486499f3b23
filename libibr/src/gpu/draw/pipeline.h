// SPDX-License-Identifier: Apache-2.0
// Pipelines and their layouts, with the states that our passes share fixed: no culling, one sample, viewport and
// scissor dynamic.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstddef>
#include <cstdint>
#include <span>

#include "gpu/device/handle.h"
#include "ibr/device.h"

namespace ibr {

/// Values of specialisation constants, seen by all stages of a pipeline. Empty: the shaders' own.
struct Specialisation {
  std::span<const VkSpecializationMapEntry> entries;
  std::span<const std::byte> data;
};

/// What becomes of colours that are there. Other than by `replace`, their alpha stays.
enum class Blending : std::uint8_t {
  replace,
  over,  // mixed by the new colour's alpha
  add,   // of alphas the greatest stays
};

struct GraphicsPipelineInfo {
  const char* name = "";
  std::span<const std::uint32_t> vertex, fragment;  // SPIR-V, entry point main; no fragment: depth only
  Specialisation specialisation;
  std::span<const VkVertexInputBindingDescription> bindings;
  std::span<const VkVertexInputAttributeDescription> attributes;
  VkPipelineLayout layout = VK_NULL_HANDLE;
  VkRenderPass renderPass = VK_NULL_HANDLE;    // subpass 0, one colour attachment; or else
  std::span<const VkFormat> colourFormats;     // of dynamic rendering
  VkFormat depthFormat = VK_FORMAT_UNDEFINED;  // likewise; without colours depth is written, untested but for depthTest
  bool attachments = true;                     // false: dynamic rendering without any; fragments only store
  bool depthTest = false;                      // passes where less,
  bool depthEqual = false;                     // or where equal too
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

/// Of `spirv`, or of what stands in for it on this device (gpu/device/shader_replacements.h), as in the pipelines
/// below.
ShaderModuleHandle shaderModule(const Device& device, std::span<const std::uint32_t> spirv);
PipelineHandle makeGraphicsPipeline(const Device& device, const GraphicsPipelineInfo& info);
PipelineHandle makeComputePipeline(const Device& device, const ComputePipelineInfo& info);

DescriptorSetLayoutHandle makeSetLayout(const Device& device, std::span<const VkDescriptorSetLayoutBinding> bindings);
PipelineLayoutHandle makePipelineLayout(const Device& device, std::span<const VkDescriptorSetLayout> sets,
                                        std::span<const VkPushConstantRange> pushConstants);

}  // namespace ibr
