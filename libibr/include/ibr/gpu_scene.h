// SPDX-License-Identifier: Apache-2.0
// A scene on the device: photographs as layers of array images, meshes in arena buffers ([T] §2.6.3, ARCHITECTURE §4).
//
// Formats are a policy of the device. Pictures in blocks (BC1, BC7) take an eighth or a quarter of the memory. GPUs
// sample them as fast as RGBA8 or faster; a software device (lavapipe) takes 1.3 to 2 times as long for a frame from
// BC1 and over 8 times from BC7. So they are kept as they are on GPUs, and decoded when they are loaded on a software
// device: BC1 where all of it fits, BC7 also where it is streamed then. A device that cannot sample them
// (Device::samplesBlocks) gets RGBA8, and the log says so.
//
// So is the filter: on a software device, which spends most of a frame filtering, one mip level is sampled instead of
// two.
//
// Without a budget, or if all photographs fit into it, everything is resident from the start and nothing streams. With
// one, `stream` is called for each frame before it is recorded:
//
//   FramePlan plan = planFrame(…);
//   gpuScene.stream(commandBuffer, plan, frame, completedFrame);
//   renderer.record(commandBuffer, plan, target);
//
// A small stand-in of each photograph (at most 64 px) is always there and is drawn while the photograph is on its way.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <functional>
#include <memory>

#include "ibr/device.h"
#include "ibr/log.h"
#include "ibr/scene.h"
#include "ibr/texture.h"

namespace ibr {

struct FramePlan;

/// A photograph's texture: level `firstLevel` and the smaller ones, down to 1×1, where level 0 has the size of the
/// node's intrinsics. The format of a node is the same at every call. Called from the thread that makes the GpuScene or
/// streams.
using TextureSource = std::function<Texture(const Scene& scene, std::size_t node, int firstLevel)>;

/// What becomes of textures in blocks (BC1, BC7).
enum class BlockTextures : std::uint8_t {
  automatic,  // kept, but decoded on software devices where that helps
  keep,       // where the device can sample them
  decode,     // to RGBA8
};

/// How photographs are sampled.
enum class TextureFilter : std::uint8_t {
  automatic,  // trilinear, but bilinear on software devices
  bilinear,   // in the nearest mip level
  trilinear,
  bicubic,  // trilinear, and by Catmull-Rom splines (Keys 1981, a = −1/2) where the finest level is magnified: sharper,
            // for 16 more reads of a photograph a pixel
};

struct GpuSceneOptions {
  TextureSource source;           // empty: the nodes' textureFile, of which no more is read than is needed
  std::uint64_t budgetBytes = 0;  // never exceeded by the sum of Memory; 0: no limit
  /// Host memory beside the budget that uploads go through, 1 MiB at least: while a scene is made, and while it
  /// streams, where it bounds what a frame uploads.
  std::uint64_t stagingBytes = std::uint64_t(32) << 20;
  /// Depth textures (Node::depthFile) in full, as `source` is called; empty: the nodes' depthFile.
  TextureSource depthSource;
  bool depth = true;  // depth textures are loaded, for Composition::gathered and hybrid; they are never streamed
  BlockTextures blocks = BlockTextures::automatic;
  TextureFilter filter = TextureFilter::automatic;
  LogCallback log;  // every step down in quality, and why
};

/// Making one submits uploads on the device's queue and waits for them. Photographs that no mesh shows are left out.
/// Throws Error (io, invalidInput, …); {outOfMemory} where the budget is too small, and says which is the smallest.
class GpuScene {
 public:
  /// With a budget the scene must outlive it.
  GpuScene(Device& device, const Scene& scene, const GpuSceneOptions& options = {});
  GpuScene(GpuScene&&) noexcept;
  GpuScene& operator=(GpuScene&&) noexcept;
  ~GpuScene();

  struct Streamed {
    std::uint32_t needed = 0;       // photographs that the plan shows
    std::uint32_t waiting = 0;      // of them: still on their way
    std::uint32_t withoutRoom = 0;  // of them: the budget has no room for them beside those that matter more
    std::uint32_t failed = 0;       // of them: cannot be read
    std::uint64_t uploadedBytes = 0;
  };
  /// Makes photographs resident in the order in which the plan needs them, then those around the main cell by their
  /// distance in the graph; reads files; records uploads into the command buffer, outside a render pass. Never waits
  /// for the device. Every plan is streamed before it is recorded, in the same command buffer or one submitted earlier.
  ///
  /// Frames are numbered from 1 upwards; `completedFrame` is the last one that the device has finished with all frames
  /// before it (0: none). A frame whose commands were never submitted is made good by using its number again.
  ///
  /// Does not throw Error. A photograph that cannot be read keeps its stand-in, and a device that has less memory than
  /// the budget lowers it; the log says so.
  Streamed stream(VkCommandBuffer commandBuffer, const FramePlan& plan, std::uint64_t frame,
                  std::uint64_t completedFrame);

  /// Whether `stream` has anything to do.
  bool streams() const noexcept;

  struct Memory {
    std::uint64_t positions = 0, indices = 0, textures = 0, depth = 0;  // bytes allocated on the device
    std::uint64_t sum() const noexcept { return positions + indices + textures + depth; }
  };
  Memory memory() const noexcept;

  struct State;
  const State& state() const noexcept { return *state_; }

 private:
  std::unique_ptr<State> state_;
};

}  // namespace ibr
