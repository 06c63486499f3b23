// SPDX-License-Identifier: Apache-2.0
// Depth textures of photographs on the device (Node::depthFile): layers of array images, one image per size.
#pragma once

#include <cstdint>
#include <stop_token>
#include <vector>

#include "base/job_queue.h"
#include "base/vulkan/gpu_image.h"
#include "gpu/transfer/upload.h"
#include "ibr/gpu_scene.h"

namespace ibr {

class DepthTextures {
 public:
  DepthTextures() = default;
  /// Reads the depth textures of `nodes` in jobs and holds all in memory meanwhile. Throws Error
  /// (io, cancelled; invalidInput for a texture of another format than rg16f or with several levels).
  DepthTextures(const Device& device, const Scene& scene, const std::vector<std::uint32_t>& nodes,
                const TextureSource& source, Uploader& uploader, JobQueue& jobs, const std::stop_token& stop);

  struct Sampled {
    VkImageView view = VK_NULL_HANDLE;
    std::uint32_t layer = 0;
    double scale = 0;  // Node::depthScale
  };
  /// Precondition: `node` is one of the constructor's nodes.
  const Sampled& at(std::uint32_t node) const noexcept { return slots_[node]; }

  std::uint64_t allocatedBytes() const noexcept;

 private:
  std::vector<GpuImage> arrays_;
  std::vector<Sampled> slots_;  // by node
};

}  // namespace ibr
