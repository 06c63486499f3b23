// SPDX-License-Identifier: Apache-2.0
// A scene on the device: photographs as layers of texture arrays, meshes in shared buffers ([T] §2.6.3).
//
// The texture format depends on the device. Block-compressed textures take an eighth (BC1) or a quarter (BC7) of the
// memory of RGBA8. GPUs sample them at least as fast as RGBA8, so they stay compressed there. A software device
// (lavapipe) needs 1.3 to 2 times as long for a frame from BC1, over 8 times from BC7. It gets RGBA8 if all decoded
// textures fit into memory; under a budget, BC7 is decoded even if the result must be streamed. A device that cannot
// sample compressed textures (Device::supportsBlockCompression) gets RGBA8, with a warning in the log.
//
// The filter depends on the device, too. A software device, which spends most of a frame filtering, samples one mip
// level instead of two.
//
// Without a budget, or if the scene fits into it, everything is resident from the start. Otherwise photographs, depth
// textures and meshes are streamed. Where needsStreaming() is true, call stream() for each frame before it is recorded:
//
//   FramePlan plan = planFrame(…);
//   gpuScene.stream(commandBuffer, plan, frame, completedFrame);
//   renderer.record(commandBuffer, plan, target);
//
// A stand-in of each streamed item stays resident and is drawn until the item has been loaded: a photograph of at most
// 64 px, a depth texture of at most 16 px, a mesh of at most 64 triangles. Meshes and textures share the budget in
// proportion to their sizes. Meshes that need at most an eighth of it are all resident.
//
// Reader threads read and decode textures, convert meshes, write both into staging memory, and allocate and free device
// memory. Frames only record copies from staging memory. With GpuSceneOptions::readerThreads 0, stream() does all this
// itself: results then do not depend on timing, as programs without a display need.
//
// Threading: one thread at a time uses a GpuScene. GpuScene::stream() and renderers of the scene must not run at the
// same time.
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <stop_token>

#include "ibr/device.h"
#include "ibr/export.h"
#include "ibr/log.h"
#include "ibr/scene.h"
#include "ibr/texture.h"
#include "ibr/uploads.h"

namespace ibr {

struct FramePlan;

/// Loads a photograph's texture: level `firstLevel` and all smaller ones, down to 1×1. Level 0 has the size of the
/// node's intrinsics. Every call must return the same format for a node. Called from several threads at a time: the
/// reader threads or those of the executor, and the thread that makes the GpuScene or calls streamAll(). With
/// readerThreads 0, only from the thread that makes the GpuScene or calls stream(). While frames are streamed, any
/// exception means that the photograph cannot be read. Must not use the GpuScene.
using TextureSource = std::function<Texture(const Scene& scene, std::size_t node, int firstLevel)>;

/// Treatment of block-compressed textures (BC1, BC7).
enum class BlockTextureMode : std::uint8_t {
  automatic,  // stay compressed; decoded on software devices where that is faster
  keep,       // stay compressed where the device can sample them
  decode,     // decoded to RGBA8
};

/// Filter with which photographs are sampled.
enum class TextureFilter : std::uint8_t {
  automatic,  // trilinear; bilinear on software devices
  bilinear,   // in the nearest mip level
  trilinear,  // between the two nearest mip levels
  bicubic,  // trilinear; Catmull-Rom splines (Keys 1981, a = −1/2) where the finest level is magnified: sharper, for 16
            // more reads of a photograph per pixel
};

/// Arranges that a job is called once on another thread, and returns at once. A job may be destroyed without a call:
/// later frames request its photographs again. Once the GpuScene is gone, jobs may still be called, without effect, or
/// destroyed. Jobs read files, decode, and allocate device memory; they may take as long as the source does. Called
/// from the thread that uses the GpuScene. Must not throw.
using JobExecutor = std::function<void(std::function<void()> job)>;

/// Maximum of GpuSceneOptions::readerThreads.
inline constexpr std::uint32_t kMaxReaderThreads = 64;

/// Options of a GpuScene.
struct GpuSceneOptions {
  TextureSource source;           // loads photographs; empty: reads the levels needed of the nodes' textureFile
  std::uint64_t budgetBytes = 0;  // maximum of GpuScene::Memory::sum(), bytes; 0: no limit
  /// Host memory for uploads, bytes, in addition to the budget; at least 1 MiB and the largest streamed item. While
  /// streaming, it limits the bytes that are being loaded or uploaded.
  std::uint64_t stagingBytes = std::uint64_t(32) << 20;
  /// Loads depth textures (Node::depthFile), called with firstLevel 0, at least twice for each of them; empty: reads
  /// the nodes' depthFile.
  TextureSource depthSource;
  bool depth = true;                                      // loads depth textures, for Composition::gathered and hybrid
  BlockTextureMode blocks = BlockTextureMode::automatic;  // treatment of BC1 and BC7 textures
  TextureFilter filter = TextureFilter::automatic;        // filter of photographs
  LogCallback log;  // gets every reduction of quality, with its reason; called on the thread that uses the GpuScene
  /// Threads of the GpuScene that read and decode, while it is made and while frames are streamed; 0: the calling
  /// thread does. At most kMaxReaderThreads. Each takes host memory for a photograph.
  std::uint32_t readerThreads = 2;
  JobExecutor executor;  // runs the jobs instead of threads of the GpuScene, at most readerThreads at a time
  /// Cancels the constructor, which then throws Error{cancelled} after at most one read of each thread.
  std::stop_token stop;
  /// Collects the uploads of the constructor instead of submitting and waiting (ibr/uploads.h), stand-ins of streamed
  /// items included. Takes as much host memory as there is to upload; stagingBytes limits one buffer.
  Uploads* uploads = nullptr;
};

/// A scene on a device, resident or streamed. Formats, streaming and threads: ibr/gpu_scene.h.
class IBR_API GpuScene {
 public:
  /// Reads files, in parallel on the reader threads, and waits for them. Allocates host and device memory. Submits
  /// uploads on the device's queue and waits for them; with GpuSceneOptions::uploads, neither. Photographs that no mesh
  /// shows are left out. Throws Error (io, invalidInput, cancelled, …), and what the sources throw; Error{outOfMemory}
  /// names the smallest possible budget where it is too small. The device must outlive the GpuScene; with a budget, so
  /// must the scene, unchanged: jobs read its meshes.
  GpuScene(Device& device, const Scene& scene, const GpuSceneOptions& options = {});
  GpuScene(GpuScene&&) noexcept;
  GpuScene& operator=(GpuScene&&) noexcept;
  /// Frees device memory. Drops requests; reads in progress end before their next mip level, and are waited for: with a
  /// TextureSource, for one call of each reader thread. Jobs that the executor has not called yet are not waited for.
  ~GpuScene();

  /// Numbers of streamed items in a frame: photographs, and meshes and depth textures if they are streamed.
  struct StreamStatus {
    std::uint32_t needed = 0;         // items that the plan shows
    std::uint32_t waiting = 0;        // needed items not loaded yet; drawn as stand-ins
    std::uint32_t overBudget = 0;     // needed items that the budget has no room for; drawn as stand-ins
    std::uint32_t failed = 0;         // needed items that cannot be read; drawn as stand-ins
    std::uint64_t uploadedBytes = 0;  // bytes that this call uploads
    std::uint32_t queued = 0;         // requested items, needed or likely to be, that no thread loads yet
    std::uint32_t reading = 0;        // items that are being loaded, or that wait for a texture array
  };
  /// Requests what the plan needs, most important first: a cell's mesh, then its photographs. Then requests what is
  /// around the main cell by its distance in the graph, some hundred items in all; earlier requests that have not begun
  /// are replaced. Records uploads of loaded items into the command buffer, outside a render pass. Every plan must be
  /// streamed before it is recorded, in the same command buffer or one submitted earlier. The time depends on what the
  /// plan shows, not on the size of the scene, nor on the budget unless that is too small.
  ///
  /// Reads no files, waits neither for reads nor for the device, and allocates neither host nor device memory. It
  /// allocates for messages, and for descriptor sets where more than 4 frames are in flight. With readerThreads 0 it
  /// reads, and allocates and frees memory of both kinds.
  ///
  /// Frames are numbered from 1 upwards. `completedFrame`: the device has finished this frame and all before it (0:
  /// none). If a frame's commands are never submitted, use its number again for the next call.
  ///
  /// Does not throw Error, except Error{outOfMemory} for lack of descriptor sets. A texture that cannot be read keeps
  /// its stand-in. If the device has less memory than the budget, the budget is lowered. Both are logged, by this
  /// call.
  StreamStatus stream(VkCommandBuffer commandBuffer, const FramePlan& plan, std::uint64_t frame,
                      std::uint64_t completedFrame);

  /// True if frames need stream(): items are streamed, or the gather binds textures frame by frame. Neither
  /// waits nor allocates.
  bool needsStreaming() const noexcept;

  /// Bytes allocated on the device. Streamed meshes share one buffer, which counts as positions.
  struct Memory {
    // positions: vertices of meshes; indices: triangles of meshes; textures: photographs; depth: depth textures
    std::uint64_t positions = 0, indices = 0, textures = 0, depth = 0;
    std::uint64_t sum() const noexcept { return positions + indices + textures + depth; }  // all bytes
  };
  /// Returns the memory at this moment; reader threads may change it. Neither waits nor allocates.
  Memory memory() const noexcept;

  struct IBR_LOCAL State;

 private:
  friend const State& stateOf(const GpuScene& scene) noexcept;
  std::unique_ptr<State> state_;
};

/// Streams until everything that the plan shows is on the device, as far as the budget allows: for single images. Reads
/// files, allocates, submits on the device's queue and waits for all of these. `frame`: number of the scene's last
/// frame, 0 before the first one; is increased. All frames must have finished. No effect where needsStreaming() is
/// false. Throws Error: io if textures cannot be read; deviceLost, outOfMemory.
IBR_API void streamAll(const Device& device, GpuScene& scene, const FramePlan& plan, std::uint64_t& frame);

}  // namespace ibr
