// SPDX-License-Identifier: Apache-2.0
// Contents of a GpuScene, for the passes of the renderer.
//
// Each photograph is resident once, as a layer of a texture array of one size and format (resident_photographs.h). A
// descriptor set binds a cell's four texture slots (photograph_sets.h), so members may differ in size, and no shader
// indexes samplers.
#pragma once

#include <memory>
#include <optional>
#include <stop_token>
#include <vector>

#include "base/job_queue.h"
#include "base/vulkan/buffer.h"
#include "base/vulkan/handle.h"
#include "gpu/transfer/upload.h"
#include "ibr/renderer.h"
#include "ibr/requirements.h"
#include "render/resident/depth_textures.h"
#include "render/resident/gather_textures.h"
#include "render/resident/photograph_sets.h"
#include "render/resident/resident_photographs.h"
#include "render/resident/wanted_nodes.h"

namespace ibr {

const GpuScene::State& stateOf(const GpuScene& scene) noexcept;

struct GpuScene::State {
  struct IndexRange {
    std::uint32_t first = 0, count = 0;
  };
  struct Mesh {                          // of a cell or a backdrop
    std::vector<std::uint32_t> members;  // nodes
    std::vector<Camera> cameras;         // of the members
    std::vector<std::uint32_t> layers;   // current layers of their photographs in the texture arrays
    std::uint32_t panoramas = 0;         // bit i: member i is a panorama
    bool masked = false;                 // a member's photograph has a mask
    bool cubic = false;                  // bicubic filter where the photographs are magnified
    std::vector<glm::dvec3> gains;       // of the members' photographs, Node::gain
    bool exposed = false;                // a photograph of the scene has a gain other than 1
    bool singleArray = false;            // all photographs are layers of one array, permanently, with one sampler
    VkDeviceSize vertexOffset = 0;       // bytes into `vertices`; q_0 … q_{d−1}, ρ: 3d + 1 floats a vertex
    IndexRange indices;                  // of its triangles of tier 0; no others are drawn
    VkDeviceSize evidenceOffset = 0;     // bytes into `evidence`; of backdrops that can be gathered from
    VkDescriptorSet photographs = VK_NULL_HANDLE;  // of a cell; null for backdrops
  };

  State(Device& device, const Scene& scene, const GpuSceneOptions& options);

  void addMeshes(Device& device, const Scene& scene, Uploader& uploader, const std::stop_token& stop);
  void addEvidence(Device& device, const Scene& scene, Uploader& uploader);

  /// Updates the mesh's layers and descriptor set to its photographs' current texture arrays.
  void bind(Mesh& mesh, std::uint64_t frame, std::uint64_t completedFrame);

  PhotographSets sets;
  std::unique_ptr<Photographs> photographs;
  Buffer vertices, indices;
  Buffer evidence;       // trust and consensus of the backdrops' vertices, 2 × 16 bits; empty: no gather
  DepthTextures depths;  // of the photographs that can be gathered from
  std::optional<GatherTextures> gather;
  std::vector<Mesh> cells, backdrops;  // in the order of the scene
  Requirements requirements;           // of the scene alone, without options
  WantedNodes wanted;                  // of the last streamed plan
  std::unique_ptr<JobQueue> jobs;      // destroyed first; null unless photographs are streamed
};

/// Bytes of a vertex with d members.
constexpr std::uint32_t vertexStride(std::size_t members) {
  return std::uint32_t((3 * members + 1) * sizeof(float));
}

}  // namespace ibr
