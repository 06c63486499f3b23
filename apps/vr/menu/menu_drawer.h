// SPDX-License-Identifier: Apache-2.0
// The menu's panel, drawn by a device into the image of a headset's layer.
//
// Colours of ImGui are display-encoded. They are drawn into an image of our own that takes them as they are, and copied
// bit by bit into the layer's: so they are the same in those that encode what is drawn (SRGB) and in those that do not.
#pragma once

#include <cstdint>
#include <optional>

#include "gpu/transfer/gpu_image.h"
#include "vr/menu/menu_panel.h"
#include "window/interface_drawer.h"

namespace ibr::app {

class MenuDrawer {
 public:
  /// `format`: of the layer's images. A frame is recorded so many times at most before the device has finished the
  /// first. Panel and device outlive it. Throws Error: unsupported where the format's values are not display-encoded
  /// ones (rawFormat in window/raw_copy.h knows it), outOfMemory.
  MenuDrawer(const Device& device, const MenuPanel& panel, VkFormat format, std::uint32_t framesInFlight);
  MenuDrawer(const MenuDrawer&) = delete;
  MenuDrawer& operator=(const MenuDrawer&) = delete;
  ~MenuDrawer();  // the device is idle

  /// Records what the panel showed last, opaque, into an image of its size that transfers may write; all of it is
  /// replaced. `before`: how it was used last.
  void record(VkCommandBuffer commands, VkImage image, ImageUse before, ImageUse after);

 private:
  const MenuPanel& panel_;
  GpuImage drawn_;
  std::optional<InterfaceDrawer> drawer_;  // made and destroyed in the panel's context
};

}  // namespace ibr::app
