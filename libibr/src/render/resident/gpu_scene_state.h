// SPDX-License-Identifier: Apache-2.0
// What GpuScene holds, for the passes of this layer.
//
// A photograph is resident once, as a layer of a page: an array image of one picture size and format
// (resident_photographs.h). A cell's four texture slots are bound by a descriptor set (photograph_sets.h), so members
// may differ in size and no sampler is ever indexed.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "gpu/device/handle.h"
#include "gpu/transfer/buffer.h"
#include "ibr/renderer.h"
#include "ibr/requirements.h"
#include "render/resident/depth_textures.h"
#include "render/resident/gather_textures.h"
#include "render/resident/photograph_sets.h"
#include "render/resident/resident_photographs.h"

namespace ibr {

struct GpuScene::State {
  struct IndexRange {
    std::uint32_t first = 0, count = 0;
  };
  struct Mesh {                          // of a cell or a backdrop
    std::vector<std::uint32_t> members;  // nodes
    std::vector<Camera> cameras;         // of the members
    std::vector<std::uint32_t> layers;   // of their photographs, now
    std::uint32_t panoramas = 0;         // bit i: member i is one
    bool masked = false;                 // a member's photograph has a mask
    bool cubic = false;                  // sampled so where they are magnified
    std::vector<glm::dvec3> gains;       // of the members' photographs, Node::gain
    bool exposed = false;                // a photograph of the scene has one that is not 1
    bool onePage = false;                // all of them are layers of one image, for good, and sampled alike
    VkDeviceSize vertexOffset = 0;       // bytes into `vertices`; q_0 … q_{d−1}, ρ: 3d + 1 floats a vertex
    IndexRange indices;                  // of its triangles of tier 0; no others are drawn
    VkDeviceSize evidenceOffset = 0;     // bytes into `evidence`; of a backdrop that can be gathered from
    VkDescriptorSet photographs = VK_NULL_HANDLE;  // of a cell
  };

  State(Device& device, const Scene& scene, const GpuSceneOptions& options);

  void addMeshes(Device& device, const Scene& scene, std::uint64_t stagingBytes);
  void addEvidence(Device& device, const Scene& scene, std::uint64_t stagingBytes);

  /// Points the mesh to where its photographs are now.
  void bind(Mesh& mesh, std::uint64_t frame, std::uint64_t completedFrame);

  PhotographSets sets;
  std::unique_ptr<Photographs> photographs;
  Buffer vertices, indices;
  Buffer evidence;       // trust and consensus of the backdrops' vertices, two times 16 bits; empty: no gather
  DepthTextures depths;  // of the photographs that can be gathered from
  std::optional<GatherTextures> gather;
  std::vector<Mesh> cells, backdrops;                   // as those of the scene
  std::vector<std::vector<std::uint32_t>> cellsOfNode;  // only where photographs are streamed
  Requirements requirements;                            // the scene's own part
};

/// Bytes of a vertex with d members.
constexpr std::uint32_t vertexStride(std::size_t members) {
  return std::uint32_t((3 * members + 1) * sizeof(float));
}

/// Nodes by how urgent they are for a plan: its photographs, its main cell's members, then those of further cells and
/// of the former order; after these, up to `most` in all, those around the main cell by their distance in the graph.
struct WantedNodes {
  std::vector<std::uint32_t> nodes;
  std::size_t needed = 0;  // of them
};
WantedNodes wantedNodes(const GpuScene::State& scene, const FramePlan& plan, std::size_t most);

}  // namespace ibr
