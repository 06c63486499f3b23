// SPDX-License-Identifier: Apache-2.0
// Test image with most basic operations: vertex upload, a canvas with depth, and composition into an offscreen image.
#pragma once

#include <glm/vec3.hpp>

#include <array>
#include <vector>

#include "base/vulkan/buffer.h"
#include "base/vulkan/handle.h"
#include "gpu/draw/canvas.h"
#include "ibr/image.h"
#include "ibr/target.h"

namespace ibr::test {

struct Vertex {
  glm::vec3 position;  // clip space, w = 1
  glm::vec3 colour;
};

/// Two triangles of a one-colour rectangle that covers [low, high] × [−1, 1] of clip space at depth z.
std::vector<Vertex> square(float low, float high, float z, glm::vec3 colour);

class PicturePasses {
 public:
  struct Settings {
    bool depth = true;        // test and write
    float brightness = 1.0f;  // specialisation constant
    VkFormat target = VK_FORMAT_R8G8B8A8_UNORM;
  };

  PicturePasses(const Device& device, VkExtent2D largest, const std::vector<Vertex>& vertices,
                const Settings& settings);

  /// Clears to (0.2, 0.4, 0.6, 0.8) and draws into the region `extent` at the canvas's corner.
  void recordCanvas(VkCommandBuffer commands, VkExtent2D extent) const noexcept;
  /// Copies the canvas's corner into the target.
  void recordComposition(VkCommandBuffer commands, const Target& target) const noexcept;

  const Canvas& canvas() const { return canvas_; }

 private:
  std::uint32_t count_;
  Canvas canvas_;
  Buffer vertices_;
  PipelineLayoutHandle drawLayout_;
  PipelineHandle draw_;
  DescriptorSetLayoutHandle setLayout_;
  DescriptorPoolHandle pool_;
  SamplerHandle sampler_;
  VkDescriptorSet set_ = VK_NULL_HANDLE;
  PipelineLayoutHandle compositionLayout_;
  PipelineHandle composition_;
};

/// 16 × 8 px: the left half red at depth 0.25, the middle half green behind red, the rest in the clear colour.
Image8 samplePicture(const Device& device);

/// Expected result of samplePicture, computed by hand.
Image8 expectedPicture();

}  // namespace ibr::test
