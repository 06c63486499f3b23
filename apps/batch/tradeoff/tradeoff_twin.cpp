// SPDX-License-Identifier: Apache-2.0
#include "batch/tradeoff/tradeoff_twin.h"

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

std::vector<ImplementationError> implementationErrors(TradeoffStage& stage, const std::vector<View>& views,
                                                      const std::function<void()>& step) {
  // Default-constructed settings: cells without filled holes, as the reference implementation draws them.
  const TradeoffWay way{.settings = RenderSettings(), .filter = TextureFilter::trilinear};
  const std::vector<std::vector<Image8>> textures = texturesOf(stage.scene(way));
  std::vector<ImplementationError> errors;
  for (const View& view : views) {
    step();
    const FramePlan plan = stage.plan(way, view.camera);
    errors.push_back(
        {deviceError(stage.scene(way), textures, plan, stage.picture(way, plan), stage.device().properties().limits),
         view.name});
  }
  return errors;
}

}  // namespace ibr::app
