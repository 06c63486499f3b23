// SPDX-License-Identifier: Apache-2.0
// Draws the mesh into the caller's image ([H] Algorithm 9). A depth-only pass comes first, so that each pixel is shaded
// once.
#pragma once

#include <array>
#include <vector>

#include "base/vulkan/gpu_image.h"
#include "base/vulkan/handle.h"
#include "htm/frame_set.h"

namespace ibr {

class HtmDrawPass {
 public:
  HtmDrawPass(const Device& device, const HtmFrameSet& set, const HtmRendererOptions& options);

  /// Call outside a render pass, after HtmCoordinatesPass::record.
  void record(VkCommandBuffer commands, const HtmFrameSet& set, const HtmFramePlan& plan,
              const Target& target) const noexcept;

 private:
  enum Shading : std::size_t { kDisplaced, kPlain, kColours, kShadingCount };
  struct Format {
    TargetFormat format;
    std::array<PipelineHandle, kShadingCount> pipelines{};
  };

  GpuImage depth_;
  PipelineHandle depthPipeline_;
  std::vector<Format> formats_;
};

}  // namespace ibr
