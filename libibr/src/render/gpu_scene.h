// SPDX-License-Identifier: Apache-2.0
// What GpuScene holds, for the passes of this layer.
//
// A photograph is resident once, as a layer of a page: an array image of one picture size. A cell's four texture slots
// are bound by a descriptor set made at load time, so members may differ in size and no sampler is ever indexed.
#pragma once

#include <vector>

#include "gpu/buffer.h"
#include "gpu/gpu_image.h"
#include "gpu/handle.h"
#include "ibr/renderer.h"
#include "ibr/requirements.h"

namespace ibr {

struct GpuScene::State {
  struct Range {
    std::uint32_t firstIndex = 0, indexCount = 0;
  };
  struct Mesh {                         // of a cell or a backdrop
    std::vector<Camera> cameras;        // of the members
    std::vector<std::uint32_t> layers;  // of their photographs
    std::uint32_t panoramas = 0;        // bit i: member i is one
    bool onePage = false;               // all are layers of one image, and sampled alike
    VkDeviceSize vertexOffset = 0;      // bytes into `vertices`; q_0 … q_{d−1}, ρ: 3d + 1 floats a vertex
    Range tier[2];                      // agreeing (a backdrop's only one), rejected
    VkDescriptorSet photographs = VK_NULL_HANDLE;
  };

  std::vector<GpuImage> pages;
  Buffer vertices, indices;
  SamplerHandle sampler;                       // of pinholes
  SamplerHandle panoramaSampler;               // goes around; only where the scene has one
  DescriptorSetLayoutHandle photographLayout;  // kSetCell of shared/cell.h
  DescriptorPoolHandle pool;
  std::vector<Mesh> cells, backdrops;  // as those of the scene
  Requirements requirements;           // the scene's own part
};

/// Bytes of a vertex with d members.
constexpr std::uint32_t vertexStride(std::size_t members) {
  return std::uint32_t((3 * members + 1) * sizeof(float));
}

}  // namespace ibr
