// SPDX-License-Identifier: Apache-2.0
// A picture without a window: an image of our own as a Renderer's target, and the way back to the host.
#pragma once

#include <vulkan/vulkan_core.h>

#include <functional>
#include <memory>

#include "ibr/device.h"
#include "ibr/image.h"
#include "ibr/target.h"

namespace ibr {

/// The device must outlive it. Used by one thread at a time.
class Offscreen {
 public:
  /// Formats: VK_FORMAT_R8G8B8A8_UNORM, B8G8R8A8_UNORM and both as SRGB, else Error{unsupported}. An extent of 0 is
  /// Error{invalidInput}; one that the device cannot have Error (unsupported, outOfMemory).
  Offscreen(const Device& device, VkExtent2D extent, VkFormat format = VK_FORMAT_R8G8B8A8_UNORM);
  Offscreen(Offscreen&&) noexcept;
  Offscreen& operator=(Offscreen&&) noexcept;
  ~Offscreen();

  /// Its contents may be replaced by drawing or by transfer; whoever writes leaves it in `after`, from which `render`
  /// reads. Valid while *this lives.
  Target target() const noexcept;

  /// Calls `record` with a command buffer, which must write the target, submits on the device's queue, waits, and
  /// returns height × width × RGBA: the values as stored (display-encoded in all formats), red first in all formats.
  /// Throws what `record` throws and Error (deviceLost, outOfMemory); it may be called again after either.
  Image8 render(const std::function<void(VkCommandBuffer)>& record);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// What Renderer::recordBuffers knows of a picture: channels as BufferTargets says.
struct FrameBuffers {
  ImageF surface;     // depth, tier, rank, extrapolation distance
  ImageF weights;     // of members 0 to 3
  ImageF confidence;  // spread, uncertainty
};

/// Images for it. The device must outlive it. Used by one thread at a time.
class OffscreenBuffers {
 public:
  /// Throws Error (invalidInput, unsupported, outOfMemory) for extents that cannot be.
  OffscreenBuffers(const Device& device, VkExtent2D extent);
  OffscreenBuffers(OffscreenBuffers&&) noexcept;
  OffscreenBuffers& operator=(OffscreenBuffers&&) noexcept;
  ~OffscreenBuffers();

  /// Valid while *this lives; whoever writes leaves them in `after`.
  BufferTargets targets() const noexcept;

  /// As Offscreen::render.
  FrameBuffers render(const std::function<void(VkCommandBuffer)>& record);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace ibr
