// SPDX-License-Identifier: Apache-2.0
#include "render/passes/uncertainties.h"

#include <algorithm>
#include <span>

namespace ibr {

Uncertainties::Uncertainties(Device& device, const Scene& scene, const GpuScene::State& meshes, Uploader& uploader)
    : meshes_(&meshes) {
  std::vector<float> values;
  for (const Cell& cell : scene.cells) {
    offsets_.push_back(values.size() * sizeof(float));
    values.insert(values.end(), cell.mesh.uncertainty.begin(), cell.mesh.uncertainty.end());
  }
  for (std::size_t c = 0; c < scene.cells.size(); ++c) {
    standInOffsets_.push_back(values.size() * sizeof(float));
    for (const std::uint32_t point : meshes.meshes.standInPoints(c))
      values.push_back(scene.cells[c].mesh.uncertainty[point]);
  }
  const auto bytes = std::as_bytes(std::span(values));
  buffer_ =
      Buffer(device, std::max<VkDeviceSize>(bytes.size(), 4),
             VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
             MemoryKind::device, "uncertainties");
  uploader.buffer(buffer_, 0, bytes);
}

VkDeviceSize Uncertainties::offset(const GpuScene::State::Mesh& cell) const noexcept {
  return (cell.place.isStandIn ? standInOffsets_ : offsets_)[std::size_t(&cell - meshes_->cells.data())];
}

}  // namespace ibr
