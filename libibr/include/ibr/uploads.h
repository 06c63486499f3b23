// SPDX-License-Identifier: Apache-2.0
// Uploads of constructors for the caller's command buffer. Without Uploads, a constructor that uploads submits on the
// device's queue and waits. With Uploads, it neither submits nor waits nor uses the queue:
//
//   Uploads uploads(device);
//   GpuScene gpuScene(device, scene, {.uploads = &uploads});
//   Renderer renderer(device, gpuScene, options);                // options.uploads = &uploads
//   uploads.record(commandBuffer);                               // before all commands that use these objects
//   renderer.record(commandBuffer, plan, target);                // … the caller submits
//   uploads.clear();                                             // once the device has finished the commands
#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <memory>

#include "ibr/device.h"
#include "ibr/export.h"

namespace ibr {

/// Collected uploads and initial layout transitions, with the host memory that they are copied from. The Device must
/// outlive it. One thread at a time uses it: a loading thread may fill it and pass it to the thread that records.
/// clear(), assignment and destruction free memory on the calling thread (ibr/device_memory.h).
///
/// Objects whose construction used the Uploads may be used by commands after record() in the same command buffer, and
/// by later submissions to the same queue; before that their contents are undefined. They must live until the recorded
/// commands have finished. Where one of them is destroyed before record(), call clear() instead, which leaves the
/// others without contents. A constructor that throws adds no uploads. Constructors throw
/// Error{invalidInput} for Uploads of another VkDevice.
class IBR_API Uploads {
 public:
  explicit Uploads(const Device& device);  // for objects of this device; allocates host memory
  Uploads(Uploads&&) noexcept;
  Uploads& operator=(Uploads&&) noexcept;
  ~Uploads();  // frees the host memory, as clear()

  /// Records all uploads since the last clear() in the order of construction, outside a render pass, with barriers that
  /// wait for earlier commands and make the contents visible to all later ones. A second call records them again, for a
  /// command buffer that is never submitted, or to restore the initial contents. Bound pipelines, descriptor sets, push
  /// constants, viewport and scissor are undefined afterwards. Submits, waits for and allocates nothing, neither host
  /// nor device memory.
  void record(VkCommandBuffer commandBuffer) const noexcept;

  /// Drops all uploads and frees their host memory (vkFreeMemory), without waiting. The device must have finished the
  /// recorded commands.
  void clear() noexcept;

  bool empty() const noexcept;  // true: record() records nothing; neither waits nor allocates
  /// Returns the bytes of host memory (MemoryKind::upload) that uploads are copied from. Neither waits nor allocates.
  std::uint64_t bytes() const noexcept;

  struct IBR_LOCAL State;

 private:
  friend State& stateOf(Uploads& uploads) noexcept;
  std::unique_ptr<State> state_;
};

}  // namespace ibr
