// SPDX-License-Identifier: Apache-2.0
// A generated scene, as data and on the test device, and images of the scene.
#pragma once

#include <numbers>
#include <utility>

#include "ibr/offscreen.h"
#include "ibr/renderer.h"
#include "ibr/texture.h"
#include "image/depth_texture.h"
#include "lab/generate/synthetic.h"

namespace ibr::test {

inline Camera cameraAt(glm::dvec3 position, double yaw = 0, double pitch = 0, int width = 320, int height = 240,
                       double fovY = std::numbers::pi / 3) {
  Camera camera;
  camera.intrinsics = pinholeFromFov(width, height, fovY);
  camera.pose = {position, glm::angleAxis(yaw, glm::dvec3(0, 1, 0)) * glm::angleAxis(pitch, glm::dvec3(1, 0, 0))};
  return camera;
}

/// A wall at 8 m and a board at half that distance, seen by d cameras a metre apart. Sizes and orientations differ: the
/// second is portrait and rolled, the third larger and turned, the fourth has an off-centre principal point.
inline SyntheticOptions place(std::size_t members) {
  SyntheticOptions options;
  options.cameras = {cameraAt({0, 0, 0}), cameraAt({1, 0, 0}, 0.05, 0, 240, 360, 1.4),
                     cameraAt({0.4, 0.9, 0.1}, -0.05, -0.05, 400, 300), cameraAt({0.5, 0.3, 0.8})};
  options.cameras[1].pose.rotation *= glm::angleAxis(0.3, glm::dvec3(0, 0, 1));
  options.cameras[3].intrinsics.cx += 13.3;
  options.cameras[3].intrinsics.cy -= 7.7;
  options.cameras.resize(members);
  options.planes = {{{0, 0, -8}, {1, 0, 0}, {0, 1, 0}, 40, 30, 1, 0.5},
                    {{0.3, 0.2, -4}, {1, 0, 0}, {0, 1, 0}, 1.6, 1.2, 2, 0.25}};
  options.gridStep = 16;
  return options;
}

/// Texture source of the source images. `place` must outlive it.
inline TextureSource photographsOf(const SyntheticScene& place) {
  return [&place](const Scene&, std::size_t node, int firstLevel) {
    return withoutLargestLevels(buildMips(place.photographs[node]), firstLevel);
  };
}

/// A scene on a device.
class Stage {
 public:
  Stage(Device& device, SyntheticScene place, GpuSceneOptions options = {})
      : place_(std::move(place)),
        textures_(mipsOf(place_)),
        bounds_(sceneBounds(place_.scene)),
        filter_(options.filter == TextureFilter::automatic ? TextureFilter::trilinear : options.filter),
        gpuScene_(device, place_.scene, withTextures(std::move(options))),
        device_(&device) {}
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  const Scene& scene() const { return place_.scene; }
  const SyntheticScene& place() const { return place_; }
  const std::vector<std::vector<Image8>>& textures() const { return textures_; }
  const GpuScene& gpuScene() const { return gpuScene_; }
  TextureFilter filter() const { return filter_; }

  /// Texture source of the source images. The stage must outlive it.
  TextureSource source() const {
    return [this](const Scene&, std::size_t node, int firstLevel) {
      return withoutLargestLevels(textures_[node], firstLevel);
    };
  }

  FramePlan plan(const Camera& view, const RenderSettings& settings = {}) const {
    return planFrame(place_.scene, bounds_, {{view}, settings});
  }
  /// Renders an RGBA image. `plan.settings.alpha` selects the content of alpha.
  Image8 render(const FramePlan& plan, TargetFormat format = VK_FORMAT_R8G8B8A8_UNORM) const {
    const VkExtent2D extent{std::uint32_t(plan.views[0].intrinsics.width),
                            std::uint32_t(plan.views[0].intrinsics.height)};
    RendererOptions options = optionsFor(plan.settings, extent, format);
    options.uncertaintyScene = &scene();
    const Renderer renderer(*device_, gpuScene_, options);
    Offscreen offscreen(*device_, extent, format);
    return offscreen.render([&](VkCommandBuffer commands) { renderer.record(commands, plan, offscreen.target()); });
  }
  Image8 render(const Camera& view, const RenderSettings& settings = {}) const { return render(plan(view, settings)); }

  /// Renders one image a view.
  std::vector<Image8> renderViews(const FramePlan& plan) const {
    const VkExtent2D extent{std::uint32_t(plan.views[0].intrinsics.width),
                            std::uint32_t(plan.views[0].intrinsics.height)};
    RendererOptions options = optionsFor(plan.settings, extent);
    options.maxViews = std::uint32_t(plan.views.size());
    const Renderer renderer(*device_, gpuScene_, options);
    std::vector<Offscreen> offscreens;
    std::vector<Target> targets;
    for (std::size_t v = 0; v < plan.views.size(); ++v)
      targets.push_back(offscreens.emplace_back(*device_, extent).target());
    std::vector<Image8> pictures;
    for (Offscreen& offscreen : offscreens)
      pictures.push_back(offscreen.render([&](VkCommandBuffer commands) { renderer.record(commands, plan, targets); }));
    return pictures;
  }

 private:
  GpuSceneOptions withTextures(GpuSceneOptions options) const {
    if (!options.source) options.source = source();
    options.filter = filter_;
    return options;
  }
  static std::vector<std::vector<Image8>> mipsOf(const SyntheticScene& place) {
    std::vector<std::vector<Image8>> all;
    for (const Image8& photograph : place.photographs) all.push_back(buildMips(photograph));
    return all;
  }

  SyntheticScene place_;
  std::vector<std::vector<Image8>> textures_;
  SceneBounds bounds_;
  TextureFilter filter_;  // fixed, because `automatic` differs between devices
  GpuScene gpuScene_;
  Device* device_;
};

/// Adds each camera's exact backdrop. With addEvidence, the backdrops can be gathered from.
inline void addBackdrops(SyntheticScene& place, const SyntheticOptions& options) {
  for (std::uint32_t n = 0; n < place.scene.nodes.size(); ++n) {
    // A cell of the camera and a neighbour. Only the half of its first member is kept.
    SyntheticOptions pair = options;
    pair.cells = {{0, 1}};
    pair.cameras = {options.cameras[n], options.cameras[n]};
    pair.cameras[1].pose.position += glm::dvec3(0.01, 0, 0);
    Cell backdrop = makeScene(pair).scene.cells[0];
    backdrop.members = {n};
    MorphMesh& mesh = backdrop.mesh;
    mesh.match.resize(1);
    mesh.ratio.resize(1);
    for (std::size_t p = 0; p < mesh.vertexCount(); ++p) {
      mesh.inverseDistance[p] /= mesh.ratio[0][p];  // relative to this member alone
      mesh.ratio[0][p] = 1;
    }
    place.scene.backdrops.push_back(backdrop);
  }
}

/// Adds evidence to backdrops, so that they can be gathered from: three photographs confirm each vertex. Depth textures
/// (farDepths) are at infinity.
inline void addEvidence(SyntheticScene& place) {
  for (Cell& backdrop : place.scene.backdrops) {
    backdrop.mesh.confirmations.assign(backdrop.mesh.vertexCount(), 3);
    backdrop.mesh.consensus.assign(backdrop.mesh.vertexCount(), 0.9f);
    Node& node = place.scene.nodes[backdrop.members[0]];
    node.depthFile = "depth/" + node.name + ".ktx2";
    node.depthScale = 1;
  }
}
inline Texture farDepths(const Scene&, std::size_t, int) {
  return depthTexture({ImageF(4, 3, 1, 0.0f), ImageF(4, 3, 1, 0.9f)}, 16).texture;
}

/// The four cameras of place() as two cells.
inline SyntheticScene twoCells() {
  SyntheticOptions options = place(4);
  options.cells = {{0, 1, 2}, {1, 2, 3}};
  return makeScene(options);
}

/// Settings in which alpha encodes the tier and holes stay empty.
inline RenderSettings withTiers() {
  RenderSettings settings;
  settings.maxTier = kTierCompleted;
  settings.alpha = AlphaContent::tier;
  return settings;
}

}  // namespace ibr::test
