// SPDX-License-Identifier: Apache-2.0
// A generated scene on the test device for gathering.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

#include "ibr/offscreen.h"
#include "ibr/renderer.h"
#include "image/half_float.h"
#include "reference/gather_stage.h"
#include "support/gpu.h"

namespace ibr::test {

inline VkExtent2D extentOf(const Camera& view) {
  return {std::uint32_t(view.intrinsics.width), std::uint32_t(view.intrinsics.height)};
}

inline Texture depthTextureOf(const ImageF& depth) {
  Texture texture;
  texture.format = TextureFormat::rg16f;
  texture.width = depth.width;
  texture.height = depth.height;
  std::vector<std::byte>& bytes = texture.levels.emplace_back(2 * depth.values.size());
  for (std::size_t i = 0; i < depth.values.size(); ++i) {
    const std::uint16_t half = toHalf(depth.values[i]);
    std::memcpy(&bytes[2 * i], &half, sizeof half);
  }
  return texture;
}

/// `stage` must outlive the object.
class OnDevice {
 public:
  explicit OnDevice(const GatherStage& stage, std::uint64_t budget = 0, TextureFormat format = TextureFormat::rgba8)
      : stage_(stage), gpuScene_(testDevice(), stage.made.scene, options(budget, format)) {}

  GpuScene& gpuScene() { return gpuScene_; }
  GpuScene::Memory memory() const { return gpuScene_.memory(); }
  Renderer renderer(const FramePlan& plan, RendererOptions wanted) const {
    for (const Camera& view : plan.views) {
      wanted.maxExtent.width = std::max(wanted.maxExtent.width, extentOf(view).width);
      wanted.maxExtent.height = std::max(wanted.maxExtent.height, extentOf(view).height);
    }
    wanted.maxViews = std::uint32_t(plan.views.size());
    wanted.uncertaintyScene = &stage_.made.scene;
    return Renderer(testDevice(), gpuScene_, wanted);
  }
  /// Renderer without filling, because the reference implementation leaves holes empty.
  Renderer renderer(const FramePlan& plan) const {
    RendererOptions wanted = optionsFor(plan.settings, {1, 1});
    wanted.fill = false;
    return renderer(plan, wanted);
  }

  std::vector<Image8> render(const FramePlan& plan, const Renderer& renderer) const {
    std::vector<Offscreen> offscreens;
    std::vector<Target> targets;
    for (const Camera& view : plan.views)
      targets.push_back(offscreens.emplace_back(testDevice(), extentOf(view)).target());
    std::vector<Image8> images;
    for (Offscreen& offscreen : offscreens)
      images.push_back(offscreen.render([&](VkCommandBuffer commands) { renderer.record(commands, plan, targets); }));
    return images;
  }
  std::vector<Image8> render(const FramePlan& plan) const { return render(plan, renderer(plan)); }
  Image8 image(const FramePlan& plan) const { return render(plan).front(); }

  FrameBuffers buffers(const FramePlan& plan) const {
    RendererOptions wanted = optionsFor(plan.settings, {1, 1});
    wanted.bufferScene = &stage_.made.scene;
    const Renderer renderer = this->renderer(plan, wanted);
    OffscreenBuffers offscreen(testDevice(), extentOf(plan.views[0]));
    return offscreen.render(
        [&](VkCommandBuffer commands) { renderer.recordBuffers(commands, plan, 0, offscreen.targets()); });
  }

 private:
  Texture encoded(std::size_t node, TextureFormat format) const {
    return format == TextureFormat::rgba8 ? Texture(stage_.textures[node])
                                          : encodeTexture(stage_.textures[node], format);
  }
  GpuSceneOptions options(std::uint64_t budget, TextureFormat format) const {
    return {
        .source = [this, format](const Scene&, std::size_t node,
                                 int firstLevel) { return withoutLargestLevels(encoded(node, format), firstLevel); },
        .budgetBytes = budget,
        .depthSource = [this](const Scene&, std::size_t node, int) { return depthTextureOf(stage_.depths[node]); },
        .filter = stage_.filter,
        .readerThreads = 0};
  }

  const GatherStage& stage_;
  GpuScene gpuScene_;
};

}  // namespace ibr::test
