// SPDX-License-Identifier: Apache-2.0
#include "window/interface.h"

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_vulkan.h>
#include <imgui.h>

#include <array>
#include <cmath>
#include <utility>

#include "base/check.h"
#include "gpu/submit.h"

namespace fs = std::filesystem;

namespace ibr::app {

Interface::Interface(const Window& window, const fs::path& layout) : layout_(layout.string()), window_(window) {
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = layout_.empty() ? nullptr : layout_.c_str();
  io.ConfigFlags |= ImGuiConfigFlags_NavEnableKeyboard;
  io.ConfigWindowsMoveFromTitleBarOnly = true;
  ImGui_ImplGlfw_InitForVulkan(window.handle(), true);
}

bool Interface::setScale(float scale) {
  if (std::exchange(scale_, scale) == scale) return false;
  // ImGui counts in the window's units, which may be larger than pixels.
  const float unit = window_.pixelsPerUnit();
  ImGuiStyle style;
  ImGui::StyleColorsDark(&style);
  style.WindowRounding = 4;
  style.FrameRounding = 3;
  style.Colors[ImGuiCol_WindowBg].w = 0.85f;
  style.ScaleAllSizes(scale / unit);
  ImGui::GetStyle() = style;
  ImGuiIO& io = ImGui::GetIO();
  ImFontConfig font;
  font.SizePixels = std::round(13 * scale);
  io.Fonts->Clear();
  io.Fonts->AddFontDefault(&font);
  io.FontGlobalScale = 1 / unit;
  return true;
}

Interface::~Interface() {
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
}

InterfaceDrawer::InterfaceDrawer(const Device& device, const Swapchain& swapchain) : device_(device) {
  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 4};
  pool_ =
      make<DescriptorPoolHandle>(device, vkCreateDescriptorPool,
                                 VkDescriptorPoolCreateInfo{.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                                            .flags = VK_DESCRIPTOR_POOL_CREATE_FREE_DESCRIPTOR_SET_BIT,
                                                            .maxSets = 4,
                                                            .poolSizeCount = 1,
                                                            .pPoolSizes = &size},
                                 "vkCreateDescriptorPool");
  const VkAttachmentDescription attachment{.format = swapchain.format(),
                                           .samples = VK_SAMPLE_COUNT_1_BIT,
                                           .loadOp = VK_ATTACHMENT_LOAD_OP_LOAD,
                                           .storeOp = VK_ATTACHMENT_STORE_OP_STORE,
                                           .stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE,
                                           .stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE,
                                           .initialLayout = use::kTransferDestination.layout,
                                           .finalLayout = Swapchain::kAfter.layout};
  const VkAttachmentReference reference{0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
  const VkSubpassDescription subpass{
      .pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS, .colorAttachmentCount = 1, .pColorAttachments = &reference};
  // Between the transfer that brings the picture and the one that takes it to the window.
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
  ImGui_ImplVulkan_InitInfo info{};
  info.Instance = device.instance();
  info.PhysicalDevice = device.physicalDevice();
  info.Device = device.handle();
  info.QueueFamily = device.queueFamily();
  info.Queue = device.queue();
  info.DescriptorPool = pool_.get();
  info.MinImageCount = kFramesInFlight;
  info.ImageCount = kFramesInFlight;
  info.MSAASamples = VK_SAMPLE_COUNT_1_BIT;
  info.CheckVkResultFn = [](VkResult result) { vk(result, "drawing the interface"); };
  check(ImGui_ImplVulkan_Init(&info, renderPass_.get()), ErrorCode::vulkan, "the interface cannot be drawn");
  submitAndWait(device, [](VkCommandBuffer commands) { ImGui_ImplVulkan_CreateFontsTexture(commands); });
  ImGui_ImplVulkan_DestroyFontUploadObjects();
}

InterfaceDrawer::~InterfaceDrawer() {
  ImGui_ImplVulkan_Shutdown();
}

void InterfaceDrawer::beginFrame() {
  ImGui_ImplVulkan_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
}

void InterfaceDrawer::makeFramebuffer(const Swapchain& swapchain, const Swapchain::Frame& frame) {
  if (generation_ == swapchain.generation()) return;
  framebuffer_ = make<FramebufferHandle>(device_, vkCreateFramebuffer,
                                         VkFramebufferCreateInfo{.sType = VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO,
                                                                 .renderPass = renderPass_.get(),
                                                                 .attachmentCount = 1,
                                                                 .pAttachments = &frame.view,
                                                                 .width = frame.extent.width,
                                                                 .height = frame.extent.height,
                                                                 .layers = 1},
                                         "vkCreateFramebuffer");
  generation_ = swapchain.generation();
}

void InterfaceDrawer::record(const Swapchain& swapchain, const Swapchain::Frame& frame) {
  makeFramebuffer(swapchain, frame);
  const VkRenderPassBeginInfo begin{.sType = VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO,
                                    .renderPass = renderPass_.get(),
                                    .framebuffer = framebuffer_.get(),
                                    .renderArea = {{0, 0}, frame.extent}};
  vkCmdBeginRenderPass(frame.commands, &begin, VK_SUBPASS_CONTENTS_INLINE);
  ImGui_ImplVulkan_RenderDrawData(ImGui::GetDrawData(), frame.commands);
  vkCmdEndRenderPass(frame.commands);
}

}  // namespace ibr::app
