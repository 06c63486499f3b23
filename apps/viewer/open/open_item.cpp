// SPDX-License-Identifier: Apache-2.0
#include "viewer/open/open_item.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/geometric.hpp>

#include "base/check.h"
#include "ibr/asset.h"
#include "io/image_file.h"
#include "shared/camera/path_recorder.h"
#include "shared/camera/up.h"
#include "shared/cli/folders.h"
#include "shared/draw/htm_renderer.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

void addModel(OpenItem& place, HtmModel model) {
  for (const HtmCamera& camera : model.cameras) place.viewpoints.push_back({camera.name, camera.camera});
  place.model = std::move(model);
}

GraphView mapOf(const std::vector<Viewpoint>& viewpoints) {
  Scene places;
  for (const Viewpoint& v : viewpoints) places.nodes.push_back({v.name, v.camera, {}, {}});
  return graphView(places);
}

// Runs on the thread that loads.
HtmPicture readPrepared(const HtmModel& model, std::size_t camera) {
  return preparedHtmPicture(model, camera, readHtmPicture(model, camera));
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

OpenItem openPlace(const fs::path& path) {
  static std::atomic<std::uint64_t> opened = 0;
  OpenItem place{.number = ++opened, .path = path, .name = folderName(path)};
  const std::optional<AssetKind> kind = assetKind(path);
  check(kind.has_value(), fs::exists(path) ? ErrorCode::invalidInput : ErrorCode::io, "{}: {}", path.string(),
        fs::exists(path) ? "is not a scene, harmonised model or 3D video" : "does not exist");
  switch (*kind) {
    case AssetKind::scene:
      place.scene = loadScene(path);
      for (const Node& node : place.scene->nodes) place.viewpoints.push_back({node.name, node.camera});
      break;
    case AssetKind::htmModel:
      addModel(place, loadHtmModel(path));
      break;
    case AssetKind::htmSequence:
      place.video = std::make_unique<HtmSequence>(path, readPrepared);
      addModel(place, place.video->frame(0)->model);
      place.playing = true;
      break;
  }
  check(!place.viewpoints.empty(), ErrorCode::invalidInput, "{}: contains no photographs", path.string());
  const std::vector<Pose> poses = place.poses();
  place.step = neighbourDistance(poses).value_or(1);
  for (const Pose& pose : poses) place.bounds.places.push_back(pose.position);
  place.bounds.neighbours = place.scene ? cellNeighbours(*place.scene) : nearNeighbours(poses, 3);
  place.bounds.radius = place.step;
  place.map = mapOf(place.viewpoints);
  place.walk.up = upOf(poses).value_or(glm::dvec3(0, 1, 0));
  place.walk.speed = firstSpeed(poses);
  if (place.model) place.walk.centre = htmBounds(*place.model).middle;
  place.flyToViewpoint(middleOf(poses), 0);
  return place;
}

std::vector<Pose> OpenItem::poses() const {
  std::vector<Pose> all;
  for (const Viewpoint& v : viewpoints) all.push_back(v.camera.pose);
  return all;
}

void OpenItem::flyToViewpoint(std::size_t viewpoint, double seconds) {
  constexpr double kOfPanorama = 1.2;  // rad
  const Camera& camera = viewpoints[viewpoint].camera;
  const Intrinsics& k = camera.intrinsics;
  flyTo(walk, camera.pose, k.model == CameraModel::pinhole ? 2 * std::atan(0.5 * k.height / k.fy) : kOfPanorama,
        seconds);
  changed = true;
}

void OpenItem::addRouteKey() {
  appendKey(route, walk.pose, walk.fovY, walk.speed);
}

void OpenItem::showRoute() {
  showingRoute = !route.keys.empty();
  routeTime = 0;
  routePose = walk.pose;
  routeFovY = walk.fovY;
  walk.flight.reset();
  // Start at the path's time, as in a video made of the path.
  if (showingRoute && video && playing) time = std::fmod(route.keys.front().time, video->duration());
  changed = true;
}

Camera cameraOf(const OpenItem& place, VkExtent2D extent) {
  return {pinholeFromFov(int(extent.width), int(extent.height), place.walk.fovY), place.walk.pose};
}

bool sameView(const Camera& a, const Camera& b) {
  return a.intrinsics == b.intrinsics && a.pose.position == b.pose.position && a.pose.rotation == b.pose.rotation;
}

}  // namespace ibr::app
