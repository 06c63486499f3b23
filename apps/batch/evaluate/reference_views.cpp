// SPDX-License-Identifier: Apache-2.0
#include "batch/evaluate/reference_views.h"

#include <algorithm>
#include <thread>
#include <utility>

#include "ibr/requirements.h"
#include "image/depth_texture.h"
#include "image/ktx2.h"

namespace ibr::app {
namespace {

ImageF depthOf(const Scene& scene, const Node& node) {
  const DepthMaps maps = readDepthTexture(readKtx2(scene.folder / node.depthFile), 1);
  ImageF both(maps.inverseDepth.width, maps.inverseDepth.height, 2);
  for (std::size_t p = 0; p < maps.inverseDepth.values.size(); ++p) {
    both.values[2 * p] = maps.inverseDepth.values[p];
    both.values[2 * p + 1] = maps.consensus.values[p];
  }
  return both;
}

}  // namespace

bool isGatherable(const Scene& scene) {
  return requirementsOf(scene, {}).gatherable > 0;
}

ReferenceViews::ReferenceViews(const Scene& scene, int threads)
    : scene_(scene),
      threads_(threads > 0 ? threads : std::max(1, int(std::thread::hardware_concurrency()))),
      bounds_(sceneBounds(scene)) {}

void ReferenceViews::take(const std::vector<PlannedPhotograph>& photographs) {
  std::map<std::uint32_t, Textures> taken;
  for (const PlannedPhotograph& photograph : photographs) {
    Textures& textures = taken[photograph.node];
    if (const auto before = textures_.find(photograph.node); before != textures_.end()) {
      textures = std::move(before->second);
      continue;
    }
    const Node& node = scene_.nodes[photograph.node];
    textures = {decodeTexture(readKtx2(scene_.folder / node.textureFile)), depthOf(scene_, node)};
  }
  textures_ = std::move(taken);
}

reference::Composed ReferenceViews::compose(const Camera& view, Exposure exposure) {
  RenderSettings settings;
  settings.composition = Composition::gathered;
  settings.voteScale = 1;
  settings.alpha = AlphaContent::tier;
  settings.maxTier = kTierFilled;
  settings.exposure = exposure;
  const FramePlan plan = planFrame(scene_, bounds_, {{view}, settings});
  take(plan.photographs);
  reference::Composed composed = reference::composeGathered(
      scene_, plan, 0,
      {.photograph = [&](std::size_t node) -> const std::vector<Image8>& {
         return textures_.at(std::uint32_t(node)).levels;
       },
       .depth = [&](std::size_t node) -> const ImageF& { return textures_.at(std::uint32_t(node)).depth; },
       .filter = TextureFilter::bicubic},
      threads_);
  reference::fillColours(composed);
  return composed;
}

}  // namespace ibr::app
