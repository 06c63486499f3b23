// SPDX-License-Identifier: Apache-2.0
// Contents of a GpuScene, for the passes of the renderer.
//
// Each photograph is resident once, as a layer of a texture array of one size and format (scene_textures.h). Meshes
// share buffers (scene_meshes.h). A descriptor set binds a cell's four texture slots (photograph_sets.h), so members
// may differ in size, and no shader indexes samplers.
#pragma once

#include <memory>
#include <optional>
#include <stop_token>
#include <vector>

#include "base/job_queue.h"
#include "base/vulkan/handle.h"
#include "gpu/transfer/upload.h"
#include "ibr/renderer.h"
#include "ibr/requirements.h"
#include "render/resident/gather_textures.h"
#include "render/resident/photograph_sets.h"
#include "render/resident/scene_meshes.h"
#include "render/resident/scene_textures.h"
#include "render/resident/streamer.h"
#include "render/resident/texture_loader.h"
#include "render/resident/wanted_items.h"

namespace ibr {

const GpuScene::State& stateOf(const GpuScene& scene) noexcept;

struct GpuScene::State {
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
    MeshPlace place;                     // current place of the mesh or of its stand-in
    VkDescriptorSet photographs = VK_NULL_HANDLE;  // of a cell; null for backdrops
  };

  State(Device& device, const Scene& scene, const GpuSceneOptions& options);

  /// `classes`: of all textures, which share the budget with the meshes.
  void makeMeshes(Device& device, const GpuSceneOptions& options, const std::vector<TextureArrayClass>& classes,
                  Uploader& uploader);
  void describeMeshes(const Scene& scene, TextureFilter filter);
  void setUpStreaming(Device& device, const Scene& scene, const GpuSceneOptions& options);

  /// Updates the mesh's layers and descriptor set to its photographs' current texture arrays.
  void bind(Mesh& mesh, std::uint64_t frame, std::uint64_t completedFrame);
  /// Updates the places, layers and descriptor sets of the meshes that a plan draws.
  void update(const FramePlan& plan, std::uint64_t frame, std::uint64_t completedFrame);

  PhotographSets sets;
  TextureLoader loader;
  SceneMeshes meshes;
  std::optional<SceneTextures> textures;
  std::unique_ptr<Streamer> streamer;  // null: everything is resident
  std::optional<GatherTextures> gather;
  std::vector<Mesh> cells, backdrops;  // in the order of the scene
  Requirements requirements;           // of the scene alone, without options
  WantedItems wanted;                  // of the last streamed plan
  std::unique_ptr<JobQueue> jobs;      // destroyed first; null where everything is resident
};

}  // namespace ibr
