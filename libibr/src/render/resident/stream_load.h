// SPDX-License-Identifier: Apache-2.0
// Jobs of streaming: loads of items into staging memory, and the allocation of texture arrays. Fields are the job's
// while it is queued or running, unless stated.
#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <string>
#include <vector>

#include "base/job_queue.h"
#include "base/vulkan/gpu_image.h"
#include "gpu/transfer/staging_pool.h"
#include "render/resident/scene_meshes.h"
#include "render/resident/texture_arrays.h"
#include "render/resident/texture_loader.h"

namespace ibr {

/// Reads a texture, or converts a mesh, into a piece of staging memory.
class StreamLoad final : public JobQueue::Job {
 public:
  enum class Phase : std::uint8_t {
    free,
    loading,  // the job is queued, running or done
    dropped,  // as loading, but the result is not needed
  };

  void run(const std::stop_token& stop) noexcept override;

  const TextureLoader* loader = nullptr;
  const SceneMeshes* meshes = nullptr;
  const TextureArrayClass* arrayClass = nullptr;  // null: of a mesh
  std::uint32_t item = 0;
  StagingPool::Piece piece;  // its memory; levels of textures from the largest on, one after another
  std::exception_ptr error;

  // Of the owner at any time:
  Phase phase = Phase::free;
  std::uint32_t array = 0, layer = 0;
};

/// Destroys texture arrays, then makes one in their memory.
class ArrayWork final : public JobQueue::Job {
 public:
  void run(const std::stop_token& stop) noexcept override;

  const Device* device = nullptr;
  const TextureArrayClass* arrayClass = nullptr;
  std::uint32_t layers = 0;
  std::vector<GpuImage> retired;
  GpuImage made;
  std::exception_ptr error;
  std::atomic<std::uint64_t> bytes = 0, depthBytes = 0;  // of all arrays that exist, and of depth textures; any thread

  // Of the owner at any time:
  bool isActive = false;  // the job is queued, running, or done without its result being used
  std::uint32_t array = 0;
};

/// The text of an exception, for messages.
std::string messageOf(const std::exception_ptr& error);

}  // namespace ibr
