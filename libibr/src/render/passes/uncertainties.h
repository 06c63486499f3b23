// SPDX-License-Identifier: Apache-2.0
// Uncertainties of ρ of all cells' vertices on the device, for buffers and overlays. A GpuScene does not have them.
#pragma once

#include <vector>

#include "base/vulkan/buffer.h"
#include "gpu/transfer/upload.h"
#include "render/resident/gpu_scene_state.h"

namespace ibr {

class Uncertainties {
 public:
  /// `scene`: the scene that `meshes` were made from; read by the constructor alone.
  Uncertainties(Device& device, const Scene& scene, const GpuScene::State& meshes, Uploader& uploader);

  VkBuffer get() const noexcept { return buffer_.get(); }
  /// Returns the offset of the uncertainties of a cell's current vertices in the buffer, bytes.
  VkDeviceSize offset(const GpuScene::State::Mesh& cell) const noexcept;
  VkDeviceSize bytes() const noexcept { return buffer_.size(); }
  VkDeviceSize allocatedBytes() const noexcept { return buffer_.allocatedBytes(); }

 private:
  const GpuScene::State* meshes_;
  std::vector<VkDeviceSize> offsets_, standInOffsets_;  // of the cells
  Buffer buffer_;
};

}  // namespace ibr
