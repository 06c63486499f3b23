// SPDX-License-Identifier: Apache-2.0
// Of every cell's vertex the uncertainty of ρ, for passes that tell it: a scene on a device has none.
#pragma once

#include <vector>

#include "gpu/transfer/buffer.h"
#include "render/resident/gpu_scene_state.h"

namespace ibr {

class Uncertainties {
 public:
  /// `scene`: what `meshes` were made of; read here only.
  Uncertainties(Device& device, const Scene& scene, const GpuScene::State& meshes);

  VkBuffer get() const noexcept { return buffer_.get(); }
  /// Where a cell of the scene begins, in bytes.
  VkDeviceSize offset(const GpuScene::State::Mesh& cell) const noexcept;
  VkDeviceSize bytes() const noexcept { return buffer_.size(); }
  VkDeviceSize allocatedBytes() const noexcept { return buffer_.allocatedBytes(); }

 private:
  const GpuScene::State* meshes_;
  std::vector<VkDeviceSize> offsets_;  // of the cells
  Buffer buffer_;
};

}  // namespace ibr
