// SPDX-License-Identifier: Apache-2.0
#include "author/poses/cross_validation.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <limits>
#include <map>

#include "base/hash.h"

namespace ibr {
namespace {

constexpr double kPatchWidth = 1.0 / 12;  // of a photograph's width
constexpr std::size_t kMinPatches = 8;
constexpr double kRoundingPx = 0.01;

// Axes that rotate with the world: the mean of the cameras' axes. If cameras look all around, the world's axes.
glm::dmat3 axesOf(std::span<const Camera> cameras) {
  glm::dmat3 sum(0.0);
  for (const Camera& camera : cameras) sum += glm::mat3_cast(camera.pose.rotation) / double(cameras.size());
  const glm::dvec3 side = glm::cross(sum[1], sum[2]);
  if (!(glm::length(side) > 0.01)) return glm::dmat3(1.0);
  const glm::dvec3 x = glm::normalize(side), z = glm::normalize(sum[2]);
  return {x, glm::cross(z, x), z};
}

}  // namespace

std::vector<std::uint32_t> patchesOf(std::span<const Camera> cameras, std::span<const BundlePoint> points) {
  glm::dvec3 middle(0.0);
  double width = 0;  // mean width of an image at distance 1
  for (const Camera& camera : cameras) {
    middle += camera.pose.position / double(cameras.size());
    width += camera.intrinsics.width / camera.intrinsics.fx / double(cameras.size());
  }
  const glm::dmat3 axes = axesOf(cameras);
  std::vector<std::uint32_t> patches;
  for (const BundlePoint& point : points) {
    const glm::dvec3 way = (glm::dvec3(point.position) - point.position.w * middle) * axes;
    const double length = glm::length(way);
    Hash hash;
    for (int c = 0; c < 3; ++c)
      hash.add(length > 0 ? std::int64_t(std::floor(way[c] / length / (kPatchWidth * width))) : 0);
    patches.push_back(std::uint32_t(hash.value() >> 20));
  }
  return patches;
}

std::vector<BundleCamera> withFixedCameras(std::span<const BundleCamera> cameras) {
  std::vector<BundleCamera> list(cameras.begin(), cameras.end());
  for (BundleCamera& camera : list) camera.fixed = camera.keepIntrinsics = true;
  return list;
}

std::vector<double> costsOf(std::span<const BundleCamera> cameras, std::span<const BundlePoint> points, double px) {
  const Bundle bundle = adjustBundle(withFixedCameras(cameras), points, {.cauchyPx = px});
  std::vector<double> costs(points.size(), 0.0);
  for (std::size_t p = 0; p < points.size(); ++p)
    if (points[p].seen.size() > 1)
      for (const auto& [camera, pixel] : points[p].seen) {
        const auto at = seenAt(bundle.cameras[camera], bundle.points[p]);
        const double off = at ? std::max(glm::distance(*at, pixel) - kRoundingPx, 0.0) / px : 1e3;
        costs[p] += std::log1p(off * off);
      }
  return costs;
}

double significance(std::span<const double> before, std::span<const double> after,
                    std::span<const std::uint32_t> patches) {
  struct Patch {
    double less = 0, points = 0;
  };
  std::map<std::uint32_t, Patch> all;
  Patch sum;
  for (std::size_t p = 0; p < before.size(); ++p) {
    if (before[p] == 0 && after[p] == 0) continue;
    for (Patch* const patch : {&all[patches[p]], &sum}) {
      patch->less += before[p] - after[p];
      patch->points += 1;
    }
  }
  if (all.size() < kMinPatches) return std::nan("");
  double squares = 0;
  for (const auto& [number, patch] : all) {
    const double off = patch.less - sum.less / sum.points * patch.points;
    squares += off * off;
  }
  return sum.less / std::sqrt(std::max(squares, std::numeric_limits<double>::min()));
}

}  // namespace ibr
