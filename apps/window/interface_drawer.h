// SPDX-License-Identifier: Apache-2.0
// What Dear ImGui has shown, drawn by a device, which may be lost and made anew while ImGui's context stays.
#pragma once

#include <cstdint>

#include "gpu/device/handle.h"
#include "ibr/device.h"
#include "ibr/target.h"

namespace ibr::app {

struct InterfaceTarget {
  VkImageView view;
  VkExtent2D extent;
  std::uint64_t generation;  // above 0; another one where the view or the extent is another
};

/// Draws for the context of ImGui that is current when it is made; that one is current at each call, and as it goes.
class InterfaceDrawer {
 public:
  /// Into images of that format; ImGui's colours are display-encoded, so UNORM is right. A frame is recorded so many
  /// times at most before the device has finished the first. Throws Error.
  InterfaceDrawer(const Device& device, VkFormat format, std::uint32_t framesInFlight);
  InterfaceDrawer(const InterfaceDrawer&) = delete;
  InterfaceDrawer& operator=(const InterfaceDrawer&) = delete;
  ~InterfaceDrawer();  // the device is idle

  /// How an image is before `record`, and after.
  static constexpr ImageUse kBefore = use::kTransferDestination, kAfter = use::kTransferSource;

  /// Before ImGui::NewFrame.
  void beginFrame();
  /// Records what was shown since then (ImGui::Render has been called) over what the image holds. Where the target's
  /// generation is another one, the device is idle.
  void record(VkCommandBuffer commands, const InterfaceTarget& target);

 private:
  void makeFramebuffer(const InterfaceTarget& target);

  const Device& device_;
  DescriptorPoolHandle pool_;
  RenderPassHandle renderPass_;
  std::uint64_t generation_ = 0;
  FramebufferHandle framebuffer_;
};

}  // namespace ibr::app
