// SPDX-License-Identifier: Apache-2.0
#include "image/depth_texture.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <glm/gtc/packing.hpp>

#include "base/check.h"

namespace ibr {
namespace {

constexpr double kPhotographPixels = 4;  // of a texel's side

}  // namespace

DepthTexture depthTexture(const ImageF& inverseDepth, const ImageF& consensus, int photographWidth) {
  assert(inverseDepth.values.size() == consensus.values.size() && !inverseDepth.empty());
  const int block = std::max(1, int(std::lround(kPhotographPixels * inverseDepth.width / photographWidth)));
  DepthTexture result;
  Texture& texture = result.texture;
  texture.format = TextureFormat::rg16f;
  texture.width = (inverseDepth.width + block - 1) / block;
  texture.height = (inverseDepth.height + block - 1) / block;
  const float largest = *std::max_element(inverseDepth.values.begin(), inverseDepth.values.end());
  if (largest > 0) result.scale = double(largest);
  std::vector<std::byte>& bytes =
      texture.levels.emplace_back(textureBytes(texture.format, texture.width, texture.height));
  for (int y = 0; y < texture.height; ++y)
    for (int x = 0; x < texture.width; ++x) {
      float rho = -1, agreed = 0;
      for (int v = y * block; v < std::min((y + 1) * block, inverseDepth.height); ++v)
        for (int u = x * block; u < std::min((x + 1) * block, inverseDepth.width); ++u)
          if (const float here = inverseDepth.pixel(u, v)[0]; here > rho) {
            rho = here;
            agreed = consensus.pixel(u, v)[0];
          }
      const std::uint16_t texel[2]{glm::packHalf1x16(float(double(rho) / result.scale)), glm::packHalf1x16(agreed)};
      std::memcpy(&bytes[sizeof texel * (std::size_t(y) * std::size_t(texture.width) + std::size_t(x))], texel,
                  sizeof texel);
    }
  return result;
}

DepthMaps depthMaps(const Texture& texture, double scale) {
  check(texture.format == TextureFormat::rg16f && texture.levels.size() == 1 &&
            texture.levels[0].size() == textureBytes(texture.format, texture.width, texture.height),
        ErrorCode::invalidInput, "a depth texture has format {} and {} levels, not rg16f and one",
        textureFormatName(texture.format), texture.levels.size());
  DepthMaps maps{ImageF(texture.width, texture.height, 1), ImageF(texture.width, texture.height, 1)};
  for (std::size_t at = 0; at < maps.inverseDepth.values.size(); ++at) {
    std::uint16_t texel[2];
    std::memcpy(texel, &texture.levels[0][sizeof texel * at], sizeof texel);
    maps.inverseDepth.values[at] = float(double(glm::unpackHalf1x16(texel[0])) * scale);
    maps.consensus.values[at] = glm::unpackHalf1x16(texel[1]);
  }
  return maps;
}

}  // namespace ibr
