// SPDX-License-Identifier: Apache-2.0
#include "render/resident/depth_textures.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "base/check.h"
#include "image/ktx2_file.h"

namespace ibr {
namespace {

void checkDepth(const Node& from, TextureFormat format, std::size_t levels) {
  check(format == TextureFormat::rg16f, ErrorCode::invalidInput, "{}: depth texture has format {}, not rg16f",
        from.name, textureFormatName(format));
  check(levels == 1, ErrorCode::invalidInput, "{}: depth texture has {} levels, not 1", from.name, levels);
}

}  // namespace

glm::ivec2 depthSize(const Scene& scene, std::uint32_t node, const TextureSource& source, const std::stop_token& stop) {
  if (source) {
    const Texture texture = readDepth(scene, node, source, stop);
    return {texture.width, texture.height};
  }
  const Ktx2Info info = probeKtx2(scene.folder / scene.nodes[node].depthFile);
  checkDepth(scene.nodes[node], info.format, std::size_t(info.levels));
  return {info.width, info.height};
}

Texture readDepth(const Scene& scene, std::uint32_t node, const TextureSource& source, const std::stop_token& stop) {
  const Node& from = scene.nodes[node];
  Texture texture = source ? source(scene, node, 0) : readKtx2(scene.folder / from.depthFile, 0, stop);
  checkDepth(from, texture.format, texture.levels.size());
  return texture;
}

Texture reducedDepth(const Texture& depth, std::uint32_t level) {
  using Texel = std::array<std::uint16_t, 2>;  // half floats >= 0 have the order of their bits
  Texture reduced;
  reduced.format = depth.format;
  reduced.width = std::max(1, depth.width >> level);
  reduced.height = std::max(1, depth.height >> level);
  reduced.levels.resize(1);
  const auto texelAt = [](const std::vector<std::byte>& bytes, int width, int x, int y) {
    Texel texel;
    std::memcpy(&texel, &bytes[(std::size_t(y) * std::size_t(width) + std::size_t(x)) * sizeof texel], sizeof texel);
    return texel;
  };
  // Blocks cover the texture: where sides are no multiples of the block's, neighbours overlap by a texel.
  const auto first = [](int at, int side, int of) { return at * of / side; };
  const auto last = [](int at, int side, int of) { return ((at + 1) * of + side - 1) / side; };
  for (int y = 0; y < reduced.height; ++y)
    for (int x = 0; x < reduced.width; ++x) {
      Texel nearest{};
      bool any = false;
      for (int v = first(y, reduced.height, depth.height); v < last(y, reduced.height, depth.height); ++v)
        for (int u = first(x, reduced.width, depth.width); u < last(x, reduced.width, depth.width); ++u) {
          const Texel here = texelAt(depth.levels[0], depth.width, u, v);
          if (any && here[0] <= nearest[0]) continue;
          nearest = here;
          any = true;
        }
      const auto bytes = std::as_bytes(std::span(nearest));
      reduced.levels[0].insert(reduced.levels[0].end(), bytes.begin(), bytes.end());
    }
  return reduced;
}

}  // namespace ibr
