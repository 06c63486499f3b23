// SPDX-License-Identifier: Apache-2.0
#include "ibr/author/poses.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <limits>
#include <vector>

#include "author/poses/bundle_adjust.h"

namespace ibr {
namespace {

constexpr std::size_t kMinPoints = 20;
constexpr double kRotationDeviation = 0.1,
                 kPositionDeviation =
                     1;  // standard deviations; kPositionDeviation: relative to the nearest other's distance

bool sameLens(const PosedImage& a, const PosedImage& b) {
  return a.camera.intrinsics == b.camera.intrinsics && a.lens == b.lens;
}

}  // namespace

std::optional<Camera> resected(const PosedModel& given, const std::string& name, const PosedModel& others) {
  const auto self = std::uint32_t(std::ranges::find(given.images, name, &PosedImage::name) - given.images.begin());
  if (given.images[self].camera.intrinsics.model != CameraModel::pinhole) return std::nullopt;
  std::vector<BundleCamera> cameras;
  std::vector<bool> there;
  double nearest = std::numeric_limits<double>::infinity();
  cameras.push_back({given.images[self].camera, 0, false, true});
  for (const PosedImage& image : given.images) {
    const auto other = std::ranges::find(others.images, image.name, &PosedImage::name);
    const bool use =
        other != others.images.end() && image.name != name && image.camera.intrinsics.model == CameraModel::pinhole;
    there.push_back(use);
    cameras.push_back({use ? other->camera : image.camera, 0, true, true});
    if (!use) continue;
    nearest = std::min(nearest, glm::distance(image.camera.pose.position, given.images[self].camera.pose.position));
    if (sameLens(image, given.images[self])) cameras[0].camera.intrinsics = other->camera.intrinsics;
  }
  std::vector<BundlePoint> points;
  for (const Track& track : given.tracks) {
    BundlePoint point{glm::dvec4(track.position, 1), {}};
    bool seen = false;
    for (const auto& [image, pixel] : track.observations) {
      if (image == self) point.seen.push_back({0, pixel});
      if (there[image]) point.seen.push_back({image + 1, pixel});
      seen = seen || image == self;
    }
    if (seen && point.seen.size() > 1) points.push_back(std::move(point));
  }
  if (points.size() < kMinPoints || !(nearest > 0)) return std::nullopt;
  BundleOptions options;
  options.radians = kRotationDeviation;
  options.shift = kPositionDeviation * nearest;
  options.minDecrease = 1e-10;
  return adjustBundle(cameras, points, options).cameras[0];
}

}  // namespace ibr
