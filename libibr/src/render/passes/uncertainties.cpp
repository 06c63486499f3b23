// SPDX-License-Identifier: Apache-2.0
#include "render/passes/uncertainties.h"

#include <algorithm>
#include <functional>
#include <span>

#include "gpu/transfer/upload.h"

namespace ibr {

Uncertainties::Uncertainties(Device& device, const Scene& scene, const GpuScene::State& meshes) : meshes_(&meshes) {
  std::vector<float> values;
  const auto append = [&](const std::vector<Cell>& cells, std::vector<VkDeviceSize>& offsets) {
    for (const Cell& cell : cells) {
      offsets.push_back(values.size() * sizeof(float));
      values.insert(values.end(), cell.mesh.uncertainty.begin(), cell.mesh.uncertainty.end());
    }
  };
  append(scene.cells, cells_);
  append(scene.backdrops, backdrops_);
  const auto bytes = std::as_bytes(std::span(values));
  buffer_ =
      Buffer(device, std::max<VkDeviceSize>(bytes.size(), 4),
             VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
             MemoryKind::device, "uncertainties");
  if (!bytes.empty()) uploadBuffer(device, buffer_, 0, bytes);
}

VkDeviceSize Uncertainties::offset(const GpuScene::State::Mesh& mesh) const noexcept {
  const auto& cells = meshes_->cells;
  const bool isCell = !std::less<>()(&mesh, cells.data()) && std::less<>()(&mesh, cells.data() + cells.size());
  return isCell ? cells_[std::size_t(&mesh - cells.data())]
                : backdrops_[std::size_t(&mesh - meshes_->backdrops.data())];
}

}  // namespace ibr
