// SPDX-License-Identifier: Apache-2.0
#include "ibr/memory_demand.h"

#include <algorithm>
#include <cassert>

#include "ibr/texture.h"

namespace ibr {
namespace {

std::uint64_t bytesWithMips(TextureFormat format, int width, int height) {
  std::uint64_t bytes = textureBytes(format, width, height);
  while (width > 1 || height > 1) {
    width = std::max(1, width / 2);
    height = std::max(1, height / 2);
    bytes += textureBytes(format, width, height);
  }
  return bytes;
}

}  // namespace

MemoryDemand memoryDemand(const Scene& scene, std::span<const TextureFormat> formats, std::uint64_t depth) {
  assert(formats.size() == scene.nodes.size());
  MemoryDemand demand;
  demand.depth = depth;
  std::vector<bool> shown(scene.nodes.size(), false);
  for (const std::vector<Cell>* cells : {&scene.cells, &scene.backdrops})
    for (const Cell& cell : *cells) {
      demand.positions += (3 * cell.members.size() + 1) * sizeof(float) * cell.mesh.vertexCount();
      if (!cell.mesh.confirmations.empty())  // trust and consensus
        demand.positions += 2 * sizeof(std::uint16_t) * cell.mesh.vertexCount();
      demand.indices += 3 * sizeof(std::uint32_t) * cell.mesh.tier0Count();
      for (const std::uint32_t member : cell.members) shown[member] = true;
    }
  for (std::size_t n = 0; n < scene.nodes.size(); ++n)
    if (shown[n]) {
      const Intrinsics& k = scene.nodes[n].camera.intrinsics;
      demand.textures += bytesWithMips(formats[n], k.width, k.height);
    }
  return demand;
}

std::vector<TextureFormat> textureFormats(const Scene& scene) {
  std::vector<TextureFormat> formats;
  for (const Node& node : scene.nodes)
    formats.push_back(node.textureFile.empty() ? TextureFormat::rgba8
                                               : probeKtx2(scene.folder / node.textureFile).format);
  return formats;
}

std::uint64_t depthTextureBytes(const Scene& scene) {
  std::uint64_t bytes = 0;
  for (const Node& node : scene.nodes) {
    if (node.depthFile.empty()) continue;
    const Ktx2Info depth = probeKtx2(scene.folder / node.depthFile);
    bytes += textureBytes(depth.format, depth.width, depth.height);
  }
  return bytes;
}

}  // namespace ibr
