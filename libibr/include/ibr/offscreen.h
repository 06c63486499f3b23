// SPDX-License-Identifier: Apache-2.0
// Rendering without a window: an image as a Renderer's target, and its readback to the host.
#pragma once

#include <vulkan/vulkan_core.h>

#include <functional>
#include <memory>

#include "ibr/device.h"
#include "ibr/export.h"
#include "ibr/image.h"
#include "ibr/target.h"

namespace ibr {

/// An offscreen image. The device must outlive it. One thread at a time uses it.
class IBR_API Offscreen {
 public:
  /// Allocates host and device memory. Submits nothing. Throws Error{unsupported} for a format that is no combination
  /// of TargetFormat, Error{invalidInput} for an extent of 0, Error (unsupported, outOfMemory) for one that the device
  /// cannot provide.
  Offscreen(const Device& device, VkExtent2D extent, TargetFormat format = VK_FORMAT_R8G8B8A8_UNORM);
  Offscreen(Offscreen&&) noexcept;
  Offscreen& operator=(Offscreen&&) noexcept;
  ~Offscreen();  // frees device memory; does not wait

  /// Returns the image as a target. Neither waits nor allocates. It may be written as a colour attachment or by
  /// transfers. Commands that write it must leave it in Target::finalUse, as render() expects. Valid while *this lives.
  Target target() const noexcept;

  /// Calls `record` with a command buffer; `record` must write the target. Then submits on the device's queue, waits,
  /// and returns new host memory of height × width × RGBA: values as stored (display-encoded), red first in all
  /// formats. Throws what `record` throws and Error (deviceLost, outOfMemory); render() may be called again after
  /// either. Throws Error{unsupported} for formats of more than 8 bits a channel, without calling `record`.
  Image8 render(const std::function<void(VkCommandBuffer)>& record);

  /// As render(), for all formats. Values are as stored: in the target's encoding (SRGB formats: display-encoded),
  /// UNORM values as shares of their maximum, 0 to 1.
  ImageF renderFloat(const std::function<void(VkCommandBuffer)>& record);

 private:
  struct IBR_LOCAL State;
  std::unique_ptr<State> state_;
};

/// Results of Renderer::recordBuffers on the host. Channels as in BufferTargets.
struct FrameBuffers {
  ImageF surface;     // depth, tier, rank, extrapolation distance
  ImageF weights;     // weights of members 0 to 3
  ImageF confidence;  // spread, uncertainty
};

/// Images for Renderer::recordBuffers. The device must outlive them. One thread at a time uses them.
class IBR_API OffscreenBuffers {
 public:
  /// Allocates host and device memory. Submits nothing. Throws Error (invalidInput, unsupported, outOfMemory) for
  /// extents that are 0 or that the device cannot provide.
  OffscreenBuffers(const Device& device, VkExtent2D extent);
  OffscreenBuffers(OffscreenBuffers&&) noexcept;
  OffscreenBuffers& operator=(OffscreenBuffers&&) noexcept;
  ~OffscreenBuffers();  // frees device memory; does not wait

  /// Returns the images as targets. Commands that write them must leave them in BufferTarget::finalUse. Valid while
  /// *this lives.
  BufferTargets targets() const noexcept;

  /// Calls `record`, submits, waits and returns the results, as Offscreen::render does.
  FrameBuffers render(const std::function<void(VkCommandBuffer)>& record);

 private:
  struct IBR_LOCAL State;
  std::unique_ptr<State> state_;
};

}  // namespace ibr
