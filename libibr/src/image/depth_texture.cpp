// SPDX-License-Identifier: Apache-2.0
#include "image/depth_texture.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>

#include "base/check.h"
#include "image/half_float.h"

namespace ibr {
namespace {

constexpr double kTexelPx = 4;  // px of the photograph

struct Texel {
  std::uint16_t inverseDepth, consensus;
};
static_assert(sizeof(Texel) == 4);

bool isIn(const ImageF& map, float low, float high) {
  return std::ranges::all_of(map.values, [&](float v) { return std::isfinite(v) && v >= low && v <= high; });
}

}  // namespace

int depthBlockSide(int mapWidth, int photographWidth) {
  return std::max(1, int(std::lround(kTexelPx * mapWidth / photographWidth)));
}

glm::ivec2 depthTextureSize(glm::ivec2 mapSize, int photographWidth) {
  const int block = depthBlockSide(mapSize.x, photographWidth);
  return {(mapSize.x + block - 1) / block, (mapSize.y + block - 1) / block};
}

DepthTexture depthTexture(const DepthMaps& maps, int photographWidth) {
  const ImageF &depth = maps.inverseDepth, &consensus = maps.consensus;
  check(!depth.empty() && depth.channels == 1 && consensus.channels == 1 && depth.width == consensus.width &&
            depth.height == consensus.height,
        ErrorCode::invalidInput, "depth maps of {}x{} and {}x{} do not have the same size and one channel", depth.width,
        depth.height, consensus.width, consensus.height);
  check(isIn(depth, 0, std::numeric_limits<float>::max()) && isIn(consensus, 0, 1), ErrorCode::invalidInput,
        "depth maps: an inverse depth is negative or not finite, or a consensus is not within 0 to 1");
  const int block = depthBlockSide(depth.width, photographWidth);
  const glm::ivec2 size = depthTextureSize({depth.width, depth.height}, photographWidth);
  const float largest = *std::ranges::max_element(depth.values);
  DepthTexture result;
  if (largest > 0) result.scale = double(largest);
  result.texture.format = TextureFormat::rg16f;
  result.texture.width = size.x;
  result.texture.height = size.y;
  std::vector<Texel> texels;
  for (int v = 0; v < size.y; ++v)
    for (int u = 0; u < size.x; ++u) {
      float most = -1, its = 0;
      for (int y = v * block; y < std::min((v + 1) * block, depth.height); ++y)
        for (int x = u * block; x < std::min((u + 1) * block, depth.width); ++x)
          if (const float here = depth.pixel(x, y)[0]; here > most) most = here, its = consensus.pixel(x, y)[0];
      texels.push_back({toHalf(float(double(most) / result.scale)), toHalf(its)});
    }
  const auto bytes = std::as_bytes(std::span(texels));
  result.texture.levels.emplace_back(bytes.begin(), bytes.end());
  return result;
}

DepthMaps readDepthTexture(const Texture& texture, double scale) {
  check(texture.format == TextureFormat::rg16f, ErrorCode::invalidInput, "a depth texture is in {}, not rg16f",
        textureFormatName(texture.format));
  check(texture.levels.size() == 1, ErrorCode::invalidInput, "a depth texture has {} levels, not 1",
        texture.levels.size());
  check(texture.width > 0 && texture.height > 0 &&
            texture.levels[0].size() == textureBytes(texture.format, texture.width, texture.height),
        ErrorCode::invalidInput, "a depth texture of {}x{} has a wrong length, {} bytes", texture.width, texture.height,
        texture.levels[0].size());
  check(scale > 0 && std::isfinite(scale), ErrorCode::invalidInput, "the scale of a depth texture, {}, is not positive",
        scale);
  DepthMaps maps{ImageF(texture.width, texture.height, 1), ImageF(texture.width, texture.height, 1)};
  for (std::size_t at = 0; at < maps.inverseDepth.values.size(); ++at) {
    Texel texel;
    std::memcpy(&texel, &texture.levels[0][at * sizeof texel], sizeof texel);
    const double depth = double(fromHalf(texel.inverseDepth)) * scale, consensus = double(fromHalf(texel.consensus));
    check(std::isfinite(float(depth)) && depth >= 0 && consensus >= 0 && consensus <= 1, ErrorCode::invalidInput,
          "texel {} of a depth texture: inverse depth {} or consensus {} is out of range", at, depth, consensus);
    maps.inverseDepth.values[at] = float(depth);
    maps.consensus.values[at] = float(consensus);
  }
  return maps;
}

}  // namespace ibr
