// SPDX-License-Identifier: Apache-2.0
// Streams photographs, depth textures and meshes to the device under a budget. Jobs read and convert them into staging
// memory, and make and destroy texture arrays; frames only record copies (ibr/gpu_scene.h).
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/job_queue.h"
#include "ibr/gpu_scene.h"
#include "render/resident/residency.h"
#include "render/resident/scene_meshes.h"
#include "render/resident/stream_copies.h"
#include "render/resident/stream_load.h"
#include "render/resident/texture_arrays.h"
#include "render/resident/texture_loader.h"

namespace ibr {

/// Maximum number of items that are queued or loaded at a time, for a number of threads of the queue. Items are
/// requested once a frame, and a slow frame lasts as long as many reads.
constexpr std::size_t maxLoads(unsigned threads) {
  return threads > 0 ? 32 * std::size_t(threads) : 1;
}

/// Textures that are streamed.
struct StreamedTextures {
  std::vector<Residency::Class> residencyClasses;  // of the classes of textures
  std::vector<std::uint32_t> classOf;              // by item; Residency::kNone: not streamed
  std::uint64_t budget = 0;                        // of the arrays, bytes
};

class Streamer {
 public:
  struct Setup {
    std::span<const TextureArrayClass> classes;
    StreamedTextures textures;
    std::uint64_t otherBytes = 0;  // of the scene's budget, for messages
    std::uint64_t stagingBytes = 0;
  };
  /// Classes, loader and meshes must outlive this object. The queue, with room for maxLoads() + 1 jobs, must have been
  /// destroyed before this object is.
  Streamer(const Device& device, JobQueue& jobs, const TextureLoader& loader, const SceneMeshes& meshes, Setup setup,
           LogCallback log);

  /// Allocates the staging memory for stream().
  void startStreaming();

  struct Sampled {
    VkImageView view;
    std::uint32_t layer;
  };
  /// Returns nullopt while the texture is not resident.
  std::optional<Sampled> texture(std::uint32_t item) const;
  /// Place of a mesh or of its stand-in. `mesh`: its number in SceneMeshes.
  MeshPlace mesh(std::uint32_t mesh) const;

  bool isStreamed(std::uint32_t item) const noexcept { return classOf_[item] != Residency::kNone; }
  /// Returns an upper bound of the items that the budget can hold: longer lists of wanted items are useless.
  std::size_t maxResident() const noexcept { return maxResident_; }

  /// As GpuScene::stream. `wanted`: items by urgency; the frame shows the first `needed`. Calls `evicting` before a
  /// texture array is destroyed.
  GpuScene::StreamStatus stream(VkCommandBuffer commandBuffer, std::span<const std::uint32_t> wanted,
                                std::size_t needed, std::uint64_t frame, std::uint64_t completedFrame,
                                const std::function<void(VkImageView)>& evicting);

  /// Waits until the most urgent job is done; runs it on the calling thread if it is queued. Returns at once where
  /// there is none.
  void finishJob();

  std::uint64_t allocatedBytes() const noexcept { return arrayWork_.bytes; }   // of texture arrays
  std::uint64_t depthBytes() const noexcept { return arrayWork_.depthBytes; }  // of these: of depth textures

 private:
  enum Group : std::uint32_t { kTextures, kMeshes };  // of Residency

  std::span<StreamLoad> loads() const noexcept { return {loads_.get(), loadCount_}; }
  bool isDone(const JobQueue::Job& job) const { return jobs_->state(job) == JobQueue::JobState::idle; }
  bool isMeshClass(std::uint32_t itemClass) const noexcept { return itemClass >= classes_.size(); }
  std::uint64_t bytesOf(std::uint32_t item) const;
  VkDeviceSize meshOffset(std::uint32_t item, std::uint32_t array, std::uint32_t slot) const;
  void collectArray();
  void updateLoads();
  void copyReady();
  bool request(const std::function<void(VkImageView)>& evicting);
  StreamLoad* nextReady();
  StreamLoad* unused();
  void freeArray(std::uint32_t array, const std::function<void(VkImageView)>& evicting);
  void makeArray(const Residency::Step& step);
  bool beginLoad(StreamLoad& load, const Residency::Step& step);
  void drop(StreamLoad& load);
  void fail(StreamLoad& load);
  GpuScene::StreamStatus endFrame();

  const Device* device_;
  JobQueue* jobs_;
  const TextureLoader* loader_;
  const SceneMeshes* meshes_;
  std::span<const TextureArrayClass> classes_;
  std::vector<Residency::Class> residencyClasses_;  // of textures, then of meshes
  std::vector<std::uint32_t> classOf_;              // by item
  std::uint64_t otherBytes_, stagingBytes_;
  LogCallback log_;

  std::optional<Residency> residency_;
  std::vector<GpuImage> arrays_;           // with the numbers of Residency; empty for chunks of meshes
  std::vector<std::uint32_t> chunkOf_;     // chunk in the pool of meshes, by array
  std::vector<std::uint32_t> freeChunks_;  // of the pool
  StreamCopies copies_;
  std::size_t loadCount_;
  std::unique_ptr<StreamLoad[]> loads_;
  ArrayWork arrayWork_;
  std::size_t maxResident_ = 0;
  std::uint64_t budget_;  // of the scene, for messages
  std::uint32_t reportedWithoutRoom_ = 0;
};

}  // namespace ibr
