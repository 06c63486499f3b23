// SPDX-License-Identifier: Apache-2.0
#include "window/interface_drawer.h"

#include <backends/imgui_impl_vulkan.h>
#include <imgui.h>

#include <algorithm>
#include <array>

#include "base/check.h"
#include "base/vulkan/functions.h"
#include "base/vulkan/submit.h"

namespace ibr::app {

InterfaceDrawer::InterfaceDrawer(const Device& device, VkFormat format, std::uint32_t framesInFlight)
    : device_(device) {
  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 4};
  pool_ =
      make<DescriptorPoolHandle>(device, vkCreateDescriptorPool,
                                 VkDescriptorPoolCreateInfo{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                                            .flags = VK_DESCRIPTOR_POOL_CREATE_FREE_DESCRIPTOR_SET_BIT,
                                                            .maxSets = 4,
                                                            .poolSizeCount = 1,
                                                            .pPoolSizes = &size},
                                 "vkCreateDescriptorPool");
  const VkAttachmentDescription attachment{.format = format,
                                           .samples = VK_SAMPLE_COUNT_1_BIT,
                                           .loadOp = VK_ATTACHMENT_LOAD_OP_LOAD,
                                           .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
                                           .stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE,
                                           .stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
                                           .initialLayout = kInitialUse.layout,
                                           .finalLayout = kFinalUse.layout};
  const VkAttachmentReference reference{0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
  const VkSubpassDescription subpass{
      .pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS, .colorAttachmentCount = 1, .pColorAttachments = &reference};
  // Synchronises with the transfer that copies the picture in and with the transfer that copies it to the window.
  const VkPipelineStageFlags drawing = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT;
  const VkAccessFlags draws = VK_ACCESS_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT;
  const std::array dependencies{VkSubpassDependency{.srcSubpass = VK_SUBPASS_EXTERNAL,
                                                    .dstSubpass = 0,
                                                    .srcStageMask = VK_PIPELINE_STAGE_TRANSFER_BIT,
                                                    .dstStageMask = drawing,
                                                    .srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
                                                    .dstAccessMask = draws},
                                VkSubpassDependency{.srcSubpass = 0,
                                                    .dstSubpass = VK_SUBPASS_EXTERNAL,
                                                    .srcStageMask = drawing,
                                                    .dstStageMask = VK_PIPELINE_STAGE_TRANSFER_BIT,
                                                    .srcAccessMask = draws,
                                                    .dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT}};
  renderPass_ = make<RenderPassHandle>(device, vkCreateRenderPass,
                                       VkRenderPassCreateInfo{.sType = VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO,
                                                              .attachmentCount = 1,
                                                              .pAttachments = &attachment,
                                                              .subpassCount = 1,
                                                              .pSubpasses = &subpass,
                                                              .dependencyCount = std::uint32_t(dependencies.size()),
                                                              .pDependencies = dependencies.data()},
                                       "vkCreateRenderPass");
  const std::uint32_t kept = std::max(framesInFlight, 2u);  // ImGui's minimum
  ImGui_ImplVulkan_InitInfo info{};
  info.Instance = device.instance();
  info.PhysicalDevice = device.physicalDevice();
  info.Device = device.handle();
  info.QueueFamily = device.queueFamily();
  info.Queue = device.queue();
  info.DescriptorPool = pool_.get();
  info.MinImageCount = kept;
  info.ImageCount = kept;
  info.MSAASamples = VK_SAMPLE_COUNT_1_BIT;
  info.CheckVkResultFn = [](VkResult result) { vk(result, "drawing the interface"); };
  check(ImGui_ImplVulkan_Init(&info, renderPass_.get()), ErrorCode::vulkan, "cannot start Dear ImGui's Vulkan backend");
#if IMGUI_VERSION_NUM < 19000
  submitAndWait(device, [](VkCommandBuffer commands) { ImGui_ImplVulkan_CreateFontsTexture(commands); });
  ImGui_ImplVulkan_DestroyFontUploadObjects();
#else
  const QueueLock lock(device);
  check(ImGui_ImplVulkan_CreateFontsTexture(), ErrorCode::vulkan, "cannot upload the interface's fonts");
#endif
}

InterfaceDrawer::~InterfaceDrawer() {
  ImGui_ImplVulkan_Shutdown();
}

void InterfaceDrawer::beginFrame() {
  ImGui_ImplVulkan_NewFrame();
}

void InterfaceDrawer::makeFramebuffer(const InterfaceTarget& target) {
  if (generation_ == target.generation) return;
  framebuffer_ = make<FramebufferHandle>(device_, vkCreateFramebuffer,
                                         VkFramebufferCreateInfo{.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
                                                                 .renderPass = renderPass_.get(),
                                                                 .attachmentCount = 1,
                                                                 .pAttachments = &target.view,
                                                                 .width = target.extent.width,
                                                                 .height = target.extent.height,
                                                                 .layers = 1},
                                         "vkCreateFramebuffer");
  generation_ = target.generation;
}

void InterfaceDrawer::record(VkCommandBuffer commands, const InterfaceTarget& target) {
  makeFramebuffer(target);
  const VkRenderPassBeginInfo begin{.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
                                    .renderPass = renderPass_.get(),
                                    .framebuffer = framebuffer_.get(),
                                    .renderArea = {{0, 0}, target.extent}};
  vkCmdBeginRenderPass(commands, &begin, VK_SUBPASS_CONTENTS_INLINE);
  ImGui_ImplVulkan_RenderDrawData(ImGui::GetDrawData(), commands);
  vkCmdEndRenderPass(commands);
}

}  // namespace ibr::app
