// SPDX-License-Identifier: Apache-2.0
// Draws Dear ImGui's draw data with a Vulkan device. The device may be lost and replaced while ImGui's context stays.
#pragma once

#include <cstdint>

#include "base/vulkan/handle.h"
#include "ibr/device.h"
#include "ibr/target.h"

namespace ibr::app {

struct InterfaceTarget {
  VkImageView view;
  VkExtent2D extent;
  std::uint64_t generation;  // above 0; changes with the view or the extent
};

/// Draws for the ImGui context that is current at construction. The same context must be current in every later call.
class InterfaceDrawer {
 public:
  /// Draws into images of `format`; ImGui's colours are display-encoded, so use UNORM. At most `framesInFlight` frames
  /// may be recorded before the device has finished the first of them. Throws Error.
  InterfaceDrawer(const Device& device, VkFormat format, std::uint32_t framesInFlight);
  InterfaceDrawer(const InterfaceDrawer&) = delete;
  InterfaceDrawer& operator=(const InterfaceDrawer&) = delete;
  ~InterfaceDrawer();  // the device must be idle

  /// Uses of the image before and after `record`.
  static constexpr ImageUse kInitialUse = use::kTransferDestination, kFinalUse = use::kTransferSource;

  /// Call before ImGui::NewFrame.
  void beginFrame();
  /// Records the frame's draw data over the image's contents. Call ImGui::Render first. The device must be idle if the
  /// target's generation has changed.
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
