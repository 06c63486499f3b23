// SPDX-License-Identifier: Apache-2.0
#include "vr/menu/menu_drawer.h"

#include "base/check.h"
#include "base/vulkan/barrier.h"
#include "base/vulkan/functions.h"
#include "vr/menu/menu_canvas.h"
#include "window/raw_copy.h"

namespace ibr::app {
namespace {

GpuImageInfo imageInfo(VkFormat format, const MenuPanel& panel) {
  check(rawFormat(format) != VK_FORMAT_UNDEFINED, ErrorCode::unsupported,
        "the menu cannot be shown in the headset: VkFormat {}", int(format));
  return {
      .format = rawFormat(format),
      .extent = {std::uint32_t(panel.width()), std::uint32_t(panel.height())},
      .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT};
}

void clear(VkCommandBuffer commands, VkImage image) {
  const ImVec4 back = ImGui::ColorConvertU32ToFloat4(kMenuBackground);
  const VkClearColorValue value{.float32 = {back.x, back.y, back.z, 1}};
  const VkImageSubresourceRange all{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  vkCmdClearColorImage(commands, image, use::kTransferDestination.layout, &value, 1, &all);
}

}  // namespace

MenuDrawer::MenuDrawer(const Device& device, const MenuPanel& panel, VkFormat format, std::uint32_t framesInFlight)
    : panel_(panel), drawn_(device, imageInfo(format, panel), "the menu's image") {
  const CurrentContext current(panel.context());
  drawer_.emplace(device, rawFormat(format), framesInFlight);
}

MenuDrawer::~MenuDrawer() {
  const CurrentContext current(panel_.context());
  drawer_.reset();
}

void MenuDrawer::record(VkCommandBuffer commands, VkImage image, ImageUse before, ImageUse after) {
  const CurrentContext current(panel_.context());
  constexpr ImageUse kDiscardedUse{VK_IMAGE_LAYOUT_UNDEFINED, VK_PIPELINE_STAGE_2_TRANSFER_BIT, VK_ACCESS_2_NONE};
  const VkExtent2D extent = drawn_.info().extent;
  transition(commands, drawn_.get(), kDiscardedUse, InterfaceDrawer::kInitialUse);
  clear(commands, drawn_.get());
  drawer_->record(commands, {drawn_.view(), extent, 1});
  transition(commands, image, {VK_IMAGE_LAYOUT_UNDEFINED, before.stages, before.access}, use::kTransferDestination);
  recordRawCopy(commands, {drawn_.get()}, {image}, extent);
  transition(commands, image, use::kTransferDestination, after);
}

}  // namespace ibr::app
