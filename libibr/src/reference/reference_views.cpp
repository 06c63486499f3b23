// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <thread>
#include <utility>

#include "ibr/author/reference.h"
#include "ibr/requirements.h"
#include "ibr/texture.h"
#include "reference/composer.h"

namespace ibr {
namespace {

struct Textures {
  std::vector<Image8> levels;
  ImageF depth;  // ρ / depthScale, consensus
};

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

struct ReferenceRenderer::State {
  void take(const std::vector<PlannedPhotograph>& photographs);

  const Scene& scene;
  int threads;
  SceneBounds bounds;
  std::map<std::uint32_t, Textures> textures;  // by node
};

ReferenceRenderer::ReferenceRenderer(const Scene& scene, int threads)
    : state_(new State{scene,
                       threads > 0 ? threads : std::max(1, int(std::thread::hardware_concurrency())),
                       sceneBounds(scene),
                       {}}) {}

ReferenceRenderer::~ReferenceRenderer() = default;

void ReferenceRenderer::State::take(const std::vector<PlannedPhotograph>& photographs) {
  std::map<std::uint32_t, Textures> taken;
  for (const PlannedPhotograph& photograph : photographs) {
    Textures& own = taken[photograph.node];
    if (const auto before = textures.find(photograph.node); before != textures.end()) {
      own = std::move(before->second);
      continue;
    }
    const Node& node = scene.nodes[photograph.node];
    own = {decodeTexture(readKtx2(scene.folder / node.textureFile)), depthOf(scene, node)};
  }
  textures = std::move(taken);
}

ReferenceView ReferenceRenderer::compose(const Camera& view, Exposure exposure) {
  RenderSettings settings;
  settings.composition = Composition::gathered;
  settings.voteScale = 1;
  settings.alpha = AlphaContent::tier;
  settings.maxTier = kTierFilled;
  settings.exposure = exposure;
  const FramePlan plan = planFrame(state_->scene, state_->bounds, {{view}, settings});
  state_->take(plan.photographs);
  reference::Composed composed = reference::composeGathered(
      state_->scene, plan, 0,
      {.photograph = [&](std::size_t node) -> const std::vector<Image8>& {
         return state_->textures.at(std::uint32_t(node)).levels;
       },
       .depth = [&](std::size_t node) -> const ImageF& { return state_->textures.at(std::uint32_t(node)).depth; },
       .filter = TextureFilter::bicubic},
      state_->threads);
  reference::fillColours(composed);
  return {std::move(composed.picture), std::move(composed.inverseDepth)};
}

}  // namespace ibr
