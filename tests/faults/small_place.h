// SPDX-License-Identifier: Apache-2.0
// A small scene and its images from every pass, recreated at each call, so that any call can fail.
#pragma once

#include <vector>

#include "reference/stage.h"

namespace ibr::test {

class SmallScene {
 public:
  SmallScene() : place_(twoCells()), bounds_(sceneBounds(place_.scene)) {
    for (const Image8& photograph : place_.photographs) mips_.push_back(buildMips(photograph));
  }
  SmallScene(const SmallScene&) = delete;
  SmallScene& operator=(const SmallScene&) = delete;

  const Scene& scene() const { return place_.scene; }
  TextureSource source() const {
    return [this](const Scene&, std::size_t node, int firstLevel) {
      return withoutLargestLevels(mips_[node], firstLevel);
    };
  }
  GpuScene open(Device& device, GpuSceneOptions options = {}) const {
    options.source = source();
    options.depthSource = farDepths;
    return GpuScene(device, place_.scene, options);
  }

  FramePlan plan(const RenderSettings& settings, std::uint32_t views = 1, int width = 48, int height = 36) const {
    std::vector<Camera> cameras;
    for (std::uint32_t v = 0; v < views; ++v)
      cameras.push_back(cameraAt({0.35 + 0.06 * v, 0.2, 0.1}, 0, 0, width, height));
    return planFrame(place_.scene, bounds_, {cameras, settings});
  }

  /// Renders with a renderer of minimum size.
  std::vector<Image8> pictures(Device& device, const GpuScene& scene, const FramePlan& plan) const {
    const Intrinsics& k = plan.views[0].intrinsics;
    const VkExtent2D extent{std::uint32_t(k.width), std::uint32_t(k.height)};
    RendererOptions options = optionsFor(plan.settings, extent);
    options.maxViews = std::uint32_t(plan.views.size());
    options.uncertaintyScene = &place_.scene;
    if (plan.settings.overlay != Overlay::none) options.hiddenArea[0] = {{-1, -1}, {-0.5, -1}, {-1, -0.5}};
    const Renderer renderer(device, scene, options);
    std::vector<Offscreen> offscreens;
    std::vector<Target> targets;
    for (std::uint32_t v = 0; v < options.maxViews; ++v)
      targets.push_back(offscreens.emplace_back(device, extent).target());
    std::vector<Image8> made;
    for (Offscreen& offscreen : offscreens)
      made.push_back(offscreen.render([&](VkCommandBuffer commands) { renderer.record(commands, plan, targets); }));
    return made;
  }

 private:
  static SyntheticScene twoCells() {
    SyntheticOptions options = place(4);
    for (Camera& camera : options.cameras) {
      Intrinsics& k = camera.intrinsics;
      k.width /= 4, k.height /= 4;
      k.fx /= 4, k.fy /= 4, k.cx /= 4, k.cy /= 4;
    }
    options.cells = {{0, 1, 2}, {1, 2, 3}};
    SyntheticScene made = makeScene(options);
    addBackdrops(made, options);
    addEvidence(made);
    return made;
  }

  SyntheticScene place_;
  SceneBounds bounds_;
  std::vector<std::vector<Image8>> mips_;
};

}  // namespace ibr::test
