// SPDX-License-Identifier: Apache-2.0
#include "batch/tradeoff/tradeoff_implementation.h"

#include "ibr/texture.h"

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

}  // namespace

std::vector<ImplementationError> implementationErrors(TradeoffRenderer& stage, const std::vector<View>& views,
                                                      const std::function<void()>& step) {
  // Default-constructed settings: cells without filled holes, as the reference implementation draws them.
  const TradeoffVariant variant{.settings = RenderSettings(), .filter = TextureFilter::trilinear};
  const std::vector<std::vector<Image8>> textures = texturesOf(stage.scene(variant));
  const VkPhysicalDeviceLimits& limits = stage.device().properties().limits;
  const DevicePrecision precision{limits.subPixelPrecisionBits, limits.subTexelPrecisionBits,
                                  limits.mipmapPrecisionBits};
  std::vector<ImplementationError> errors;
  for (const View& view : views) {
    step();
    const FramePlan plan = stage.plan(variant, view.camera);
    errors.push_back(
        {differenceFromReference(stage.scene(variant), textures, plan, stage.picture(variant, plan), precision),
         view.name});
  }
  return errors;
}

}  // namespace ibr::app
