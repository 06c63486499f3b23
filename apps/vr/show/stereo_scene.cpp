// SPDX-License-Identifier: Apache-2.0
#include "vr/show/stereo_scene.h"

#include <algorithm>

#include "base/check.h"
#include "base/stop.h"
#include "ibr/asset.h"
#include "ibr/requirements.h"
#include "shared/camera/roaming.h"
#include "shared/camera/up.h"

namespace ibr::app {
namespace {

RoamingBounds boundsOf(const Scene& scene) {
  RoamingBounds bounds;
  const std::vector<Pose> poses = posesOf(scene);
  for (const Pose& pose : poses) bounds.positions.push_back(pose.position);
  bounds.neighbours = cellNeighbours(scene);
  bounds.radius = neighbourDistance(poses).value_or(1);
  return bounds;
}

template <class T>
void addNew(std::vector<T>& all, const std::vector<T>& more) {
  for (const T& one : more)
    if (std::ranges::find(all, one) == all.end()) all.push_back(one);
}

// Returns the union of the options that these settings need.
RendererOptions optionsFor(std::span<const RenderSettings> levels, const EyeFormat& eyes) {
  RendererOptions all = ibr::optionsFor(levels.front(), eyes.extent, eyes.format);
  double maxRenderScale = levels.front().renderScale;
  for (const RenderSettings& level : levels.subspan(1)) {
    const RendererOptions one = ibr::optionsFor(level, eyes.extent, eyes.format);
    addNew(all.orders, one.orders);
    addNew(all.blends, one.blends);
    addNew(all.overlays, one.overlays);
    addNew(all.compositions, one.compositions);
    all.gatherCandidates = std::max(all.gatherCandidates, one.gatherCandidates);
    all.voteScale = std::max(all.voteScale, one.voteScale);
    all.crossFadeOrders |= one.crossFadeOrders;
    all.fill |= one.fill;
    all.floor |= one.floor;
    all.dissolve |= one.dissolve;
    all.colour = std::max(all.colour, one.colour);
    maxRenderScale = std::max(maxRenderScale, level.renderScale);
  }
  const bool scaled = std::ranges::any_of(levels, [](const RenderSettings& s) { return s.renderScale != 1; });
  all.maxRenderScale = scaled ? maxRenderScale : 0;
  all.maxViews = 2;
  all.depth = true;
  return all;
}

}  // namespace

LoadedScene readScene(const std::filesystem::path& path, double unitsPerMetre, bool alignCells,
                      const std::stop_token& stop) {
  check(assetKind(path).value_or(AssetKind::scene) == AssetKind::scene, ErrorCode::unsupported,
        "{}: ibr-vr shows scenes only; open harmonised models in ibr-viewer", path.string());
  LoadedScene files{.path = path, .scene = loadScene(path, stop)};
  check(!files.scene.nodes.empty(), ErrorCode::invalidInput, "{}: the scene has no photographs", path.string());
  files.bounds = sceneBounds(files.scene, alignCells, stop);
  const std::vector<Pose> poses = posesOf(files.scene);
  const std::optional<glm::dvec3> up = upOf(poses);
  files.canBeGathered = requirementsOf(files.scene, {}).gatherable > 0;
  files.middle = centreOf(poses);
  files.level = up.has_value();
  const glm::dvec3 upwards = up.value_or(glm::dvec3(0, 1, 0));
  files.walk = makeWalkScene(spotsOf(poses, upwards), upwards, unitsPerMetre, boundsOf(files.scene));
  return files;
}

StereoScene::StereoScene(Device device, std::shared_ptr<const LoadedScene> files,
                         std::span<const RenderSettings> levels, bool floor, const EyeFormat& eyes,
                         const GpuSceneOptions& options)
    : device_(std::move(device)),
      files_(std::move(files)),
      gpuScene_(device_, files_->scene, options),
      eyes_(eyes),
      floor_(floor) {
  checkStop(options.stop, "uploading the scene");
  setLevels(levels);
}

void StereoScene::setLevels(std::span<const RenderSettings> levels) {
  rendererOptions_ = optionsFor(levels, eyes_);
  rendererOptions_.floor |= floor_;
  setHiddenArea(eyes_.hiddenArea);
}

void StereoScene::setHiddenArea(const std::array<std::vector<glm::vec2>, 2>& area) {
  eyes_.hiddenArea = rendererOptions_.hiddenArea = area;
  renderer_.reset();  // release first, so that two renderers never hold memory at once
  renderer_.emplace(device_, gpuScene_, rendererOptions_);
}

void StereoScene::record(const FrameRing::Frame& frame, double seconds, const std::array<Camera, 2>& eyes,
                         const RenderSettings& settings, std::span<const Target> targets) {
  input_.views.assign(eyes.begin(), eyes.end());
  input_.settings = settings;
  input_.dtSeconds = seconds;
  planFrame(files_->scene, files_->bounds, input_, plan_.next, plan_);
  streamed_ = gpuScene_.stream(frame.commands, plan_, frame.number, frame.completed);
  renderer_->record(frame.commands, plan_, targets, frame.timer);
}

}  // namespace ibr::app
