// SPDX-License-Identifier: Apache-2.0
// Copies both eyes' images to the host. The frame that is copied does not wait.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "base/vulkan/buffer.h"
#include "ibr/image.h"
#include "ibr/target.h"
#include "vr/headset/eye_images.h"

namespace ibr::app {

/// One copy of both eyes' images. The frame's thread records the copy and submits; once the frame has finished, any
/// thread reads the copy and releases the object for the next copy.
class EyeCapture {
 public:
  explicit EyeCapture(const Device& device) : device_(device) {}

  bool isFree() const noexcept { return free_; }
  /// Records copies of both eyes' images, which must be in use::kColourAttachment and stay so. Precondition: isFree().
  /// Allocates memory for a larger image than before.
  void record(VkCommandBuffer commands, const EyeImages& images);
  /// Call after the commands were submitted with this frame: the object is not free until release().
  void submitted(std::uint64_t frame) noexcept;
  std::uint64_t frame() const noexcept { return frame_; }

  /// Returns display-encoded RGB. Call after the device has finished the frame.
  std::array<Image8, 2> read() const;
  void release() noexcept { free_ = true; }

 private:
  const Device& device_;
  std::atomic<bool> free_ = true;
  std::uint64_t frame_ = 0;
  VkExtent2D extent_{0, 0};
  bool blueFirst_ = false;
  std::array<Buffer, 2> bytes_;
};

}  // namespace ibr::app
