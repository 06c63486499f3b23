// SPDX-License-Identifier: Apache-2.0
#include "viewer/place.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <limits>

#include "base/check.h"
#include "ibr/asset.h"
#include "io/image_file.h"
#include "shared/htm_renderer.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

glm::dvec3 upOf(const std::vector<Viewpoint>& viewpoints) {
  glm::dvec3 sum(0);
  for (const Viewpoint& v : viewpoints) sum += v.camera.pose.rotation * glm::dvec3(0, 1, 0);
  const double length = glm::length(sum);
  return length > 0.1 * double(viewpoints.size()) ? sum / length : glm::dvec3(0, 1, 0);
}

double stepOf(const std::vector<Viewpoint>& viewpoints) {
  std::vector<double> nearest;
  for (const Viewpoint& a : viewpoints) {
    double least = std::numeric_limits<double>::infinity();
    for (const Viewpoint& b : viewpoints)
      if (const double d = glm::distance(a.camera.pose.position, b.camera.pose.position); d > 0)
        least = std::min(least, d);
    if (std::isfinite(least)) nearest.push_back(least);
  }
  if (nearest.empty()) return 1;
  std::ranges::nth_element(nearest, nearest.begin() + std::ptrdiff_t(nearest.size() / 2));
  return nearest[nearest.size() / 2];
}

void addModel(Place& place, HtmModel model) {
  for (const HtmCamera& camera : model.cameras) place.viewpoints.push_back({camera.name, camera.camera});
  place.model = std::move(model);
}

// The photograph nearest to the middle of all.
std::size_t middleOf(const std::vector<Viewpoint>& viewpoints) {
  glm::dvec3 middle(0);
  for (const Viewpoint& v : viewpoints) middle += v.camera.pose.position / double(viewpoints.size());
  const auto nearest = std::ranges::min_element(
      viewpoints, {}, [&](const Viewpoint& v) { return glm::distance(v.camera.pose.position, middle); });
  return std::size_t(nearest - viewpoints.begin());
}

}  // namespace

Place openPlace(const fs::path& path) {
  Place place{.path = path, .name = fs::absolute(path).lexically_normal().filename().string()};
  if (place.name.empty()) place.name = fs::absolute(path).parent_path().filename().string();
  const std::optional<AssetKind> kind = assetKind(path);
  check(kind.has_value(), fs::exists(path) ? ErrorCode::invalidInput : ErrorCode::io, "{}: {}", path.string(),
        fs::exists(path) ? "is no scene, harmonised model or 3D video" : "is missing");
  switch (*kind) {
    case AssetKind::scene:
      place.scene = loadScene(path);
      for (const Node& node : place.scene->nodes) place.viewpoints.push_back({node.name, node.camera});
      break;
    case AssetKind::htmModel:
      addModel(place, loadHtmModel(path));
      break;
    case AssetKind::htmSequence:
      place.video = std::make_unique<HtmSequence>(path, readHtmPicture);
      addModel(place, place.video->frame(0)->model);
      place.playing = true;
      break;
  }
  check(!place.viewpoints.empty(), ErrorCode::invalidInput, "{}: has no photographs", path.string());
  place.up = upOf(place.viewpoints);
  place.step = stepOf(place.viewpoints);
  place.speed = place.step;
  place.snapTo(middleOf(place.viewpoints));
  return place;
}

void Place::snapTo(std::size_t viewpoint) {
  constexpr double kOfPanorama = 1.2;  // rad
  const Camera& camera = viewpoints[viewpoint].camera;
  const Intrinsics& k = camera.intrinsics;
  pose = camera.pose;
  fovY = k.model == CameraModel::pinhole ? 2 * std::atan(0.5 * k.height / k.fy) : kOfPanorama;
  snapped = viewpoint;
  changed = true;
}

Camera cameraOf(const Place& place, VkExtent2D extent) {
  return {pinholeFromFov(int(extent.width), int(extent.height), place.fovY), place.pose};
}

bool sameView(const Camera& a, const Camera& b) {
  return a.intrinsics == b.intrinsics && a.pose.position == b.pose.position && a.pose.rotation == b.pose.rotation;
}

}  // namespace ibr::app
