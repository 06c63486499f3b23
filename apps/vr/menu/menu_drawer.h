// SPDX-License-Identifier: Apache-2.0
// Draws the menu's panel with a Vulkan device into the image of a headset layer.
//
// ImGui's colours are display-encoded. They are drawn into an own UNORM image, which is copied bit by bit into the
// layer's image. SRGB and UNORM layers therefore show the same colours.
#pragma once

#include <cstdint>
#include <optional>

#include "base/vulkan/gpu_image.h"
#include "vr/menu/menu_panel.h"
#include "window/interface_drawer.h"

namespace ibr::app {

class MenuDrawer {
 public:
  /// `format`: of the layer's images. At most `framesInFlight` frames may be recorded before the device has finished
  /// the first of them. Panel and device must outlive the drawer. Throws Error: unsupported if rawFormat
  /// (window/raw_copy.h) does not know the format, outOfMemory.
  MenuDrawer(const Device& device, const MenuPanel& panel, VkFormat format, std::uint32_t framesInFlight);
  MenuDrawer(const MenuDrawer&) = delete;
  MenuDrawer& operator=(const MenuDrawer&) = delete;
  ~MenuDrawer();  // the device must be idle

  /// Records the panel's last frame, opaque, over all of `image`, which must have the panel's size and transfer usage.
  /// `before`: the image's last use.
  void record(VkCommandBuffer commands, VkImage image, ImageUse before, ImageUse after);

 private:
  const MenuPanel& panel_;
  GpuImage drawn_;
  std::optional<InterfaceDrawer> drawer_;  // created and destroyed with the panel's context current
};

}  // namespace ibr::app
