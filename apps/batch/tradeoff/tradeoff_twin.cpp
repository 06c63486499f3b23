// SPDX-License-Identifier: Apache-2.0
#include "batch/tradeoff/tradeoff_twin.h"

#include <algorithm>
#include <cmath>

#include "image/ktx2.h"
#include "reference/cell_pass_reference.h"

namespace ibr::app {
namespace {

std::vector<std::vector<Image8>> texturesOf(const Scene& scene) {
  std::vector<std::vector<Image8>> textures;
  for (const Node& node : scene.nodes) {
    textures.emplace_back();
    if (!node.textureFile.empty()) textures.back() = decodeTexture(readKtx2(scene.folder / node.textureFile, 0));
  }
  return textures;
}

ImplementationError errorOf(const Image8& picture, const reference::Picture& twin,
                            const VkPhysicalDeviceLimits& limits) {
  const double step = std::exp2(-double(limits.subTexelPrecisionBits)),
               levelStep = std::exp2(-double(limits.mipmapPrecisionBits));
  ImplementationError error{.largestLevels = 0};
  double sum = 0, values = 0, beyond = 0;
  for (int y = 0; y < twin.height; ++y)
    for (int x = 0; x < twin.width; ++x) {
      const std::size_t at = std::size_t(y) * std::size_t(twin.width) + std::size_t(x);
      if (!reference::isCertain(twin, at, limits.subPixelPrecisionBits)) continue;
      const double bound = 1 + std::ceil(2 * step * twin.range[at] + levelStep * twin.levelRange[at]);
      for (int c = 0; c < 3; ++c) {
        const double off = std::abs(picture.pixel(x, y)[std::size_t(c)] - twin.colour[at][c] * 255);
        sum += off;
        ++values;
        beyond += off > bound;
        error.largestLevels = std::max(error.largestLevels, off);
      }
    }
  error.compared = values / (3.0 * twin.width * twin.height);
  error.meanLevels = sum / values;
  error.beyondBound = values > 0 ? beyond / values : 0;
  return error;
}

}  // namespace

std::vector<ImplementationError> implementationErrors(TradeoffStage& stage, const std::vector<View>& views,
                                                      const std::function<void()>& step) {
  // Default-constructed settings: cells without filled holes, as the reference implementation draws them.
  const TradeoffWay way{.settings = RenderSettings(), .filter = TextureFilter::trilinear};
  const std::vector<std::vector<Image8>> textures = texturesOf(stage.scene(way));
  std::vector<ImplementationError> errors;
  for (const View& view : views) {
    step();
    const FramePlan plan = stage.plan(way, view.camera);
    errors.push_back(errorOf(stage.picture(way, plan), reference::render(stage.scene(way), textures, plan),
                             stage.device().properties().limits));
    errors.back().name = view.name;
  }
  return errors;
}

}  // namespace ibr::app
