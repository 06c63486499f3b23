// SPDX-License-Identifier: Apache-2.0
// Copies both eyes' images to the host.
#pragma once

#include <array>

#include "base/vulkan/buffer.h"
#include "ibr/image.h"
#include "ibr/target.h"
#include "vr/headset/eye_images.h"

namespace ibr::app {

class EyeCapture {
 public:
  explicit EyeCapture(const Device& device) : device_(device) {}

  /// Records copies of both eyes' images, which must be in use::kColourAttachment and stay so.
  void record(VkCommandBuffer commands, const EyeImages& images);

  /// Returns display-encoded RGB. Call after the device has finished the recorded commands.
  std::array<Image8, 2> read() const;

 private:
  const Device& device_;
  VkExtent2D extent_{0, 0};
  bool blueFirst_ = false;
  std::array<Buffer, 2> bytes_;
};

}  // namespace ibr::app
