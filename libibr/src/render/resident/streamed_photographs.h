// SPDX-License-Identifier: Apache-2.0
// Photographs that are streamed into texture arrays under a budget. Files are read, and arrays are made and destroyed,
// in jobs; frames only copy what is there (ibr/gpu_scene.h).
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/job_queue.h"
#include "ibr/gpu_scene.h"
#include "render/resident/photograph_load.h"
#include "render/resident/photograph_stream.h"
#include "render/resident/residency.h"
#include "render/resident/texture_arrays.h"
#include "render/resident/texture_loader.h"

namespace ibr {

/// Maximum number of photographs that are queued, read or copied at a time, for a number of threads of the queue.
constexpr std::size_t maxLoads(unsigned threads) {
  return threads > 0 ? 4 * std::size_t(threads) : 1;
}

class StreamedPhotographs {
 public:
  struct Setup {
    std::span<const TextureArrayClass> classes;
    std::vector<Residency::Class> residencyClasses;  // of `classes`
    std::vector<std::uint32_t> classOf;              // by node; Residency::kNone: not streamed
    std::uint64_t budget = 0;                        // of the arrays, bytes
    std::uint64_t otherBytes = 0;                    // of the scene's budget, for messages
    std::uint64_t stagingBytes = 0;
  };
  /// Classes and loader must outlive this object. The queue, with room for maxLoads() + 1 jobs, must have been
  /// destroyed before this object is.
  StreamedPhotographs(const Device& device, JobQueue& jobs, const TextureLoader& loader, Setup setup, LogCallback log);

  /// Allocates the ring of staging memory for stream().
  void startStreaming() { stream_ = PhotographStream(*device_, stagingBytes_); }

  struct Sampled {
    VkImageView view;
    std::uint32_t layer;
  };
  /// Returns nullopt while the photograph is not resident.
  std::optional<Sampled> at(std::uint32_t node) const;

  /// As GpuScene::stream. `wanted`: nodes by urgency; the frame shows the first `needed`. Calls `evicting` before a
  /// texture array is destroyed.
  GpuScene::StreamStatus stream(VkCommandBuffer commandBuffer, std::span<const std::uint32_t> wanted,
                                std::size_t needed, std::uint64_t frame, std::uint64_t completedFrame,
                                const std::function<void(VkImageView)>& evicting);

  /// Waits until the most urgent job is done; runs it on the calling thread if it is queued. Returns at once where
  /// there is none.
  void finishJob();

  std::uint64_t allocatedBytes() const noexcept { return arrayWork_.bytes; }

 private:
  std::span<PhotographLoad> loads() const noexcept { return {loads_.get(), loadCount_}; }
  bool isDone(const JobQueue::Job& job) const { return jobs_->state(job) == JobQueue::JobState::idle; }
  void collectArray();
  void updateLoads();
  void copyReady();
  bool request(const std::function<void(VkImageView)>& evicting);
  PhotographLoad* nextReady();
  PhotographLoad* unused();
  void makeArray(const Residency::Step& step);
  void beginLoad(PhotographLoad& load, const Residency::Step& step);
  void clear(PhotographLoad& load);
  GpuScene::StreamStatus endFrame();

  const Device* device_;
  JobQueue* jobs_;
  std::span<const TextureArrayClass> classes_;
  std::vector<Residency::Class> residencyClasses_;
  std::vector<std::uint32_t> classOf_;
  std::uint64_t otherBytes_, stagingBytes_;
  LogCallback log_;

  Residency residency_;
  std::vector<GpuImage> arrays_;  // with the numbers of Residency
  PhotographStream stream_;
  std::size_t minLoads_, loadCount_;
  std::unique_ptr<PhotographLoad[]> loads_;
  PhotographLoad* copying_ = nullptr;
  ArrayWork arrayWork_;
  std::uint64_t budget_;  // of the scene, for messages
  std::uint32_t reportedWithoutRoom_ = 0;
};

}  // namespace ibr
