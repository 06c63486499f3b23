// SPDX-License-Identifier: Apache-2.0
#include "viewer/open/open_item.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "base/check.h"
#include "ibr/asset.h"
#include "io/image_file.h"
#include "shared/camera/path_recorder.h"
#include "shared/camera/up.h"
#include "shared/cli/folders.h"
#include "shared/draw/htm_model_renderer.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

void addModel(OpenItem& item, HtmModel model) {
  for (const HtmCamera& camera : model.cameras) item.viewpoints.push_back({camera.name, camera.camera});
  item.model = std::move(model);
}

GraphView mapOf(const std::vector<Viewpoint>& viewpoints) {
  Scene positions;
  for (const Viewpoint& v : viewpoints) positions.nodes.push_back({v.name, v.camera, {}, {}});
  return graphView(positions);
}

// Runs on the thread that loads.
HtmImage readPrepared(const HtmModel& model, std::size_t camera) {
  return prepareHtmImage(model, camera, readHtmPicture(model, camera));
}

// Returns the index of the photograph nearest to the mean position.
std::size_t middleOf(const std::vector<Pose>& poses) {
  glm::dvec3 middle(0);
  for (const Pose& pose : poses) middle += pose.position / double(poses.size());
  const auto nearest =
      std::ranges::min_element(poses, {}, [&](const Pose& pose) { return glm::distance(pose.position, middle); });
  return std::size_t(nearest - poses.begin());
}

}  // namespace

OpenItem openItem(const fs::path& path, const std::stop_token& stop) {
  static std::atomic<std::uint64_t> opened = 0;
  OpenItem item{.number = ++opened, .path = path, .name = folderName(path)};
  const std::optional<AssetKind> kind = assetKind(path);
  check(kind.has_value(), fs::exists(path) ? ErrorCode::invalidInput : ErrorCode::io, "{}: {}", path.string(),
        fs::exists(path) ? "is not a scene, harmonised model or 3D video" : "does not exist");
  switch (*kind) {
    case AssetKind::scene:
      item.scene = loadScene(path, stop);
      item.sceneBounds = sceneBounds(*item.scene, false, stop);
      for (const Node& node : item.scene->nodes) item.viewpoints.push_back({node.name, node.camera});
      break;
    case AssetKind::htmModel:
      addModel(item, loadHtmModel(path));
      break;
    case AssetKind::htmSequence:
      item.video = std::make_unique<HtmSequence>(path, readPrepared);
      addModel(item, item.video->frame(0)->model);
      item.playing = true;
      break;
  }
  check(!item.viewpoints.empty(), ErrorCode::invalidInput, "{}: contains no photographs", path.string());
  const std::vector<Pose> poses = item.poses();
  item.step = neighbourDistance(poses).value_or(1);
  for (const Pose& pose : poses) item.bounds.positions.push_back(pose.position);
  item.bounds.neighbours = item.scene ? cellNeighbours(*item.scene) : nearNeighbours(poses, 3);
  item.bounds.radius = item.step;
  addIndex(item.bounds);
  item.map = mapOf(item.viewpoints);
  std::vector<glm::dvec2> onMap;
  for (const Pose& pose : poses) onMap.push_back(item.map.flat(pose.position));
  item.mapMarks = item.scene ? mapMarks(std::move(onMap), item.bounds.neighbours) : mapMarks(std::move(onMap), {});
  item.navigation.up = upOf(poses).value_or(glm::dvec3(0, 1, 0));
  item.navigation.speed = initialSpeed(poses);
  if (item.model) item.navigation.centre = htmBounds(*item.model).middle;
  item.flyToViewpoint(middleOf(poses), 0);
  return item;
}

std::vector<Pose> OpenItem::poses() const {
  std::vector<Pose> all;
  for (const Viewpoint& v : viewpoints) all.push_back(v.camera.pose);
  return all;
}

bool OpenItem::canAlign() {
  if (hasAnchors) return true;
  if (!aligned.isRunning())
    aligned = Background<SceneBounds>(
        [&place = *scene](const std::stop_token& stop) { return ibr::sceneBounds(place, true, stop); });
  if (!aligned.isReady()) return false;
  sceneBounds.anchors = aligned.take().anchors;
  return hasAnchors = true;
}

void OpenItem::flyToViewpoint(std::size_t viewpoint, double seconds) {
  constexpr double kPanoramaFovY = 1.2;  // rad
  const Camera& camera = viewpoints[viewpoint].camera;
  const Intrinsics& k = camera.intrinsics;
  flyTo(navigation, camera.pose, k.model == CameraModel::pinhole ? 2 * std::atan(0.5 * k.height / k.fy) : kPanoramaFovY,
        seconds);
  changed = true;
}

void OpenItem::addPathKey() {
  appendKey(cameraPath, navigation.pose, navigation.fovY, navigation.speed);
}

void OpenItem::showCameraPath() {
  playingPath = !cameraPath.keys.empty();
  pathTime = 0;
  pathPose = navigation.pose;
  pathFovY = navigation.fovY;
  navigation.flight.reset();
  // Start at the path's time, as in a video made of the path.
  if (playingPath && video && playing) time = std::fmod(cameraPath.keys.front().time, video->duration());
  changed = true;
}

Camera cameraOf(const OpenItem& item, VkExtent2D extent) {
  return {pinholeFromFov(int(extent.width), int(extent.height), item.navigation.fovY), item.navigation.pose};
}

bool sameView(const Camera& a, const Camera& b) {
  return a.intrinsics == b.intrinsics && a.pose.position == b.pose.position && a.pose.rotation == b.pose.rotation;
}

}  // namespace ibr::app
