// SPDX-License-Identifier: Apache-2.0
#include "render/resident/depth_textures.h"

#include <algorithm>
#include <map>
#include <span>
#include <utility>

#include "base/check.h"
#include "ibr/texture.h"
#include "image/ktx2_file.h"
#include "render/resident/read_in_order.h"
#include "render/resident/texture_arrays.h"

namespace ibr {
namespace {

Texture readDepth(const Scene& scene, std::uint32_t node, const TextureSource& source, const std::stop_token& stop) {
  const Node& from = scene.nodes[node];
  Texture texture = source ? source(scene, node, 0) : readKtx2(scene.folder / from.depthFile, 0, stop);
  check(texture.format == TextureFormat::rg16f, ErrorCode::invalidInput, "{}: depth texture has format {}, not rg16f",
        from.name, textureFormatName(texture.format));
  check(texture.levels.size() == 1, ErrorCode::invalidInput, "{}: depth texture has {} levels, not 1", from.name,
        texture.levels.size());
  return texture;
}

}  // namespace

DepthTextures::DepthTextures(const Device& device, const Scene& scene, const std::vector<std::uint32_t>& nodes,
                             const TextureSource& source, Uploader& uploader, JobQueue& jobs,
                             const std::stop_token& stop)
    : slots_(scene.nodes.size()) {
  // A depth texture has a quarter of its photograph's sides, so all may be in memory while they are sorted by size.
  std::map<std::pair<int, int>, std::vector<std::pair<std::uint32_t, Texture>>> bySize;
  readInOrder<Texture>(
      jobs, nodes.size(), stop,
      [&](std::size_t i, const std::stop_token& reading) { return readDepth(scene, nodes[i], source, reading); },
      [&](std::size_t i, Texture texture) {
        const std::pair size{texture.width, texture.height};
        bySize[size].emplace_back(nodes[i], std::move(texture));
      });
  const std::size_t most = device.properties().limits.maxImageArrayLayers;
  for (const auto& [size, textures] : bySize)
    for (std::size_t first = 0; first < textures.size(); first += most) {
      const std::size_t count = std::min(most, textures.size() - first);
      const VkExtent2D extent{std::uint32_t(size.first), std::uint32_t(size.second)};
      const GpuImage& array =
          arrays_.emplace_back(device,
                               GpuImageInfo{.format = vulkanFormat(TextureFormat::rg16f),
                                            .extent = extent,
                                            .layers = std::uint32_t(count),
                                            .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT,
                                            .viewType = VK_IMAGE_VIEW_TYPE_2D_ARRAY},
                               "depths of photographs");
      uploader.beginImage(array);
      for (std::size_t i = 0; i < count; ++i) {
        const auto& [node, texture] = textures[first + i];
        uploader.image(array, std::uint32_t(i), 0, extent, std::span(texture.levels[0]));
        slots_[node] = {array.view(), std::uint32_t(i), scene.nodes[node].depthScale};
      }
    }
}

std::uint64_t DepthTextures::allocatedBytes() const noexcept {
  std::uint64_t bytes = 0;
  for (const GpuImage& array : arrays_) bytes += array.allocatedBytes();
  return bytes;
}

}  // namespace ibr
