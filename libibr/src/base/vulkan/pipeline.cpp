// SPDX-License-Identifier: Apache-2.0
#include "base/vulkan/pipeline.h"

#include <array>
#include <cassert>

#include "base/vulkan/debug.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/shader_replacements.h"

namespace ibr {
namespace {

VkSpecializationInfo specialisationInfo(const Specialisation& values) {
  return {.mapEntryCount = std::uint32_t(values.entries.size()),
          .pMapEntries = values.entries.data(),
          .dataSize = values.data.size(),
          .pData = values.data.data()};
}

VkPipelineShaderStageCreateInfo stageInfo(VkShaderStageFlagBits stage, const ShaderModuleHandle& shader,
                                          const VkSpecializationInfo& specialisation) {
  return {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
          .stage = stage,
          .module = shader.get(),
          .pName = "main",
          .pSpecializationInfo = &specialisation};
}

VkPipelineColorBlendAttachmentState blendState(Blending blending) {
  VkPipelineColorBlendAttachmentState state{.colorWriteMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT |
                                                              VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT};
  if (blending == Blending::replace) return state;
  state.blendEnable = VK_TRUE;
  if (blending == Blending::add) {
    state.srcColorBlendFactor = state.dstColorBlendFactor = VK_BLEND_FACTOR_ONE;
    state.alphaBlendOp = VK_BLEND_OP_MAX;
    return state;
  }
  state.srcColorBlendFactor = VK_BLEND_FACTOR_SRC_ALPHA;
  state.dstColorBlendFactor = VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA;
  state.colorWriteMask &= ~VkColorComponentFlags(VK_COLOR_COMPONENT_A_BIT);
  return state;
}

}  // namespace

ShaderModuleHandle shaderModule(const Device& device, std::span<const std::uint32_t> spirv) {
  spirv = shaderReplacements(device).currentWords(spirv);
  const VkShaderModuleCreateInfo info{
      .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, .codeSize = spirv.size_bytes(), .pCode = spirv.data()};
  return make<ShaderModuleHandle>(device, vkCreateShaderModule, info, "vkCreateShaderModule");
}

PipelineHandle makeGraphicsPipeline(const Device& device, const GraphicsPipelineInfo& info) {
  const bool depthOnly = info.depthFormat != VK_FORMAT_UNDEFINED && info.colourFormats.empty();
  assert((info.renderPass != VK_NULL_HANDLE) + !info.colourFormats.empty() + depthOnly + !info.attachments == 1);
  constexpr std::uint32_t kMaxColours = 4;
  const auto colours = info.renderPass ? 1u : std::uint32_t(info.colourFormats.size());
  assert(colours <= kMaxColours);
  const ShaderModuleHandle vertex = shaderModule(device, info.vertex);
  const ShaderModuleHandle fragment =
      info.fragment.empty() ? ShaderModuleHandle() : shaderModule(device, info.fragment);
  const VkSpecializationInfo specialisation = specialisationInfo(info.specialisation);
  const VkPipelineShaderStageCreateInfo stages[]{stageInfo(VK_SHADER_STAGE_VERTEX_BIT, vertex, specialisation),
                                                 stageInfo(VK_SHADER_STAGE_FRAGMENT_BIT, fragment, specialisation)};

  const VkPipelineVertexInputStateCreateInfo vertexInput{
      .sType = VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO,
      .vertexBindingDescriptionCount = std::uint32_t(info.bindings.size()),
      .pVertexBindingDescriptions = info.bindings.data(),
      .vertexAttributeDescriptionCount = std::uint32_t(info.attributes.size()),
      .pVertexAttributeDescriptions = info.attributes.data()};
  const VkPipelineInputAssemblyStateCreateInfo assembly{
      .sType = VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO,
      .topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST};
  const VkPipelineViewportStateCreateInfo viewport{
      .sType = VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO, .viewportCount = 1, .scissorCount = 1};
  const VkPipelineRasterizationStateCreateInfo rasterisation{
      .sType = VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO,
      .depthClampEnable = info.depthClamp,
      .polygonMode = VK_POLYGON_MODE_FILL,
      .cullMode = VK_CULL_MODE_NONE,
      .lineWidth = 1.0f};
  const VkPipelineMultisampleStateCreateInfo samples{.sType = VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO,
                                                     .rasterizationSamples = VK_SAMPLE_COUNT_1_BIT};
  const VkPipelineDepthStencilStateCreateInfo depth{.sType = VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO,
                                                    .depthTestEnable = info.depthTest || depthOnly,
                                                    .depthWriteEnable = info.depthWrite || depthOnly,
                                                    .depthCompareOp = depthOnly && !info.depthTest
                                                                          ? VK_COMPARE_OP_ALWAYS
                                                                      : info.depthEqual ? VK_COMPARE_OP_LESS_OR_EQUAL
                                                                                        : VK_COMPARE_OP_LESS};
  std::array<VkPipelineColorBlendAttachmentState, kMaxColours> blends{};
  blends.fill(blendState(info.blending));
  const VkPipelineColorBlendStateCreateInfo blending{.sType = VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO,
                                                     .attachmentCount = colours,
                                                     .pAttachments = blends.data()};
  constexpr VkDynamicState kDynamic[]{VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
  const VkPipelineDynamicStateCreateInfo dynamic{.sType = VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO,
                                                 .dynamicStateCount = 2,
                                                 .pDynamicStates = kDynamic};
  const VkPipelineRenderingCreateInfo rendering{.sType = VK_STRUCTURE_TYPE_PIPELINE_RENDERING_CREATE_INFO,
                                                .colorAttachmentCount = colours,
                                                .pColorAttachmentFormats = info.colourFormats.data(),
                                                .depthAttachmentFormat = info.depthFormat};

  const VkGraphicsPipelineCreateInfo pipelineInfo{.sType = VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO,
                                                  .pNext = info.renderPass == VK_NULL_HANDLE ? &rendering : nullptr,
                                                  .stageCount = info.fragment.empty() ? 1u : 2u,
                                                  .pStages = stages,
                                                  .pVertexInputState = &vertexInput,
                                                  .pInputAssemblyState = &assembly,
                                                  .pViewportState = &viewport,
                                                  .pRasterizationState = &rasterisation,
                                                  .pMultisampleState = &samples,
                                                  .pDepthStencilState = &depth,
                                                  .pColorBlendState = &blending,
                                                  .pDynamicState = &dynamic,
                                                  .layout = info.layout,
                                                  .renderPass = info.renderPass};
  VkPipeline pipeline = VK_NULL_HANDLE;
  vk(vkCreateGraphicsPipelines(device.handle(), device.pipelineCache(), 1, &pipelineInfo, nullptr, &pipeline),
     "vkCreateGraphicsPipelines");
  PipelineHandle owner(device.handle(), pipeline);
  nameObject(device, VK_OBJECT_TYPE_PIPELINE, pipeline, info.name);
  return owner;
}

PipelineHandle makeComputePipeline(const Device& device, const ComputePipelineInfo& info) {
  const ShaderModuleHandle shader = shaderModule(device, info.shader);
  const VkSpecializationInfo specialisation = specialisationInfo(info.specialisation);
  const VkComputePipelineCreateInfo pipelineInfo{
      .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
      .stage = stageInfo(VK_SHADER_STAGE_COMPUTE_BIT, shader, specialisation),
      .layout = info.layout};
  VkPipeline pipeline = VK_NULL_HANDLE;
  vk(vkCreateComputePipelines(device.handle(), device.pipelineCache(), 1, &pipelineInfo, nullptr, &pipeline),
     "vkCreateComputePipelines");
  PipelineHandle owner(device.handle(), pipeline);
  nameObject(device, VK_OBJECT_TYPE_PIPELINE, pipeline, info.name);
  return owner;
}

DescriptorSetLayoutHandle makeSetLayout(const Device& device, std::span<const VkDescriptorSetLayoutBinding> bindings) {
  const VkDescriptorSetLayoutCreateInfo info{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
                                             .bindingCount = std::uint32_t(bindings.size()),
                                             .pBindings = bindings.data()};
  return make<DescriptorSetLayoutHandle>(device, vkCreateDescriptorSetLayout, info, "vkCreateDescriptorSetLayout");
}

PipelineLayoutHandle makePipelineLayout(const Device& device, std::span<const VkDescriptorSetLayout> sets,
                                        std::span<const VkPushConstantRange> pushConstants) {
  const VkPipelineLayoutCreateInfo info{.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                        .setLayoutCount = std::uint32_t(sets.size()),
                                        .pSetLayouts = sets.data(),
                                        .pushConstantRangeCount = std::uint32_t(pushConstants.size()),
                                        .pPushConstantRanges = pushConstants.data()};
  return make<PipelineLayoutHandle>(device, vkCreatePipelineLayout, info, "vkCreatePipelineLayout");
}

}  // namespace ibr
