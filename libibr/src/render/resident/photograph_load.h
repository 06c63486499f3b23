// SPDX-License-Identifier: Apache-2.0
// Jobs of streaming: reads of photographs, and the allocation of their texture arrays. Fields are the job's while it is
// queued or running, unless stated.
#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <string>
#include <vector>

#include "base/job_queue.h"
#include "base/vulkan/gpu_image.h"
#include "render/resident/texture_arrays.h"
#include "render/resident/texture_loader.h"

namespace ibr {

/// Reads a photograph for a layer of a texture array. Frees the texture of the previous run.
class PhotographLoad final : public JobQueue::Job {
 public:
  enum class Phase : std::uint8_t {
    free,
    reading,   // the job is queued, running or done
    dropped,   // as reading, but the result is not needed
    copying,   // the job is done, and the texture is being uploaded
    clearing,  // the job frees the texture
  };

  void run(const std::stop_token& stop) noexcept override;

  const TextureLoader* loader = nullptr;
  const TextureArrayClass* arrayClass = nullptr;  // null: only frees the texture
  std::uint32_t node = 0;
  Texture texture;
  std::exception_ptr error;

  // Of the owner at any time:
  Phase phase = Phase::free;
  std::uint32_t array = 0, layer = 0;
  std::uint64_t bytes = 0;  // of the texture
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
  std::atomic<std::uint64_t> bytes = 0;  // of all arrays that exist; any thread

  // Of the owner at any time:
  bool isActive = false;  // the job is queued, running, or done without its result being used
  std::uint32_t array = 0;
};

/// The text of an exception, for messages.
std::string messageOf(const std::exception_ptr& error);

}  // namespace ibr
