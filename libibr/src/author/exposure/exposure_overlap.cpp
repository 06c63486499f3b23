// SPDX-License-Identifier: Apache-2.0
#include "author/exposure/exposure_overlap.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include "author/graph/view_relations.h"

namespace ibr {
namespace {

constexpr int kGridSide = 96;                                      // samples along a photograph's longest side
constexpr int kMinConfirmations = 1;                               // for a depth to be used
constexpr std::size_t kMaxPairPoints = 1200, kMinPairPoints = 20;  // points of a pair …
constexpr std::size_t kMaxTotalPoints = 350000;                    // … limited by this total of all pairs
constexpr std::size_t kMinSharedPoints = 60;
constexpr std::size_t kMaxNeighbours = 20, kMaxCandidates = 60;
constexpr double kMaxParallax = 0.002;    // radians; below, points are taken at half the nearest inverse distance
constexpr double kDepthTolerance = 0.02;  // relative, between the inverse distances of two photographs
constexpr double kMaxRayAngle = 0.45;     // radians, between two rays to a point
constexpr double kNearQuantile = 0.95;    // quantile of inverse distances that defines `nearest`

// A photograph with its known depth.
struct PhotographWithDepth {
  const Camera* camera;
  const PhotographDepth* depth;
  double nearest = -1;  // 95 % quantile of inverse distances, 1 / world unit; < 0: unknown
};

glm::dvec3 worldRay(const Camera& camera, glm::dvec2 pixel) {
  return camera.pose.rotation * unproject(camera.intrinsics, pixel);
}

std::vector<glm::dvec2> gridOf(const Intrinsics& k) {
  const double step = std::max(k.width, k.height) / double(kGridSide);
  std::vector<glm::dvec2> grid;
  for (double y = step / 2; y < k.height; y += step)
    for (double x = step / 2; x < k.width; x += step) grid.emplace_back(x, y);
  return grid;
}

// Returns nullopt where the depth is unknown.
std::optional<double> inverseDistanceAt(const PhotographWithDepth& around, glm::dvec2 pixel) {
  const ImageF& map = around.depth->matched.map.inverseDepth;
  const Intrinsics& k = around.camera->intrinsics;
  const int x = std::clamp(int(pixel.x * map.width / k.width), 0, map.width - 1),
            y = std::clamp(int(pixel.y * map.height / k.height), 0, map.height - 1);
  const int confirmations = around.depth->evidence.confirmations.pixel(x, y)[0];
  if (confirmations < kMinConfirmations) return std::nullopt;
  return double(map.pixel(x, y)[0]) * (k.model == CameraModel::pinhole ? -unproject(k, pixel).z : 1.0);
}

PhotographWithDepth withDepth(const Camera& camera, const std::vector<double>& tracks, const PhotographDepth& depth) {
  PhotographWithDepth around{&camera, &depth, -1};
  std::vector<double> inverse = tracks;
  for (const glm::dvec2 pixel : gridOf(camera.intrinsics))
    if (const auto known = inverseDistanceAt(around, pixel)) inverse.push_back(*known);
  if (inverse.empty()) return around;
  const auto near = inverse.begin() + std::ptrdiff_t(kNearQuantile * double(inverse.size() - 1));
  std::nth_element(inverse.begin(), near, inverse.end());
  around.nearest = *near;
  return around;
}

bool isInside(const Intrinsics& k, glm::dvec2 p) {
  return p.x >= 0 && p.y >= 0 && p.x < k.width && p.y < k.height;
}

// Max angle between the optical axis and a corner of the image.
double maxAxisAngle(const Intrinsics& k) {
  if (k.model == CameraModel::equirectangular) return std::numbers::pi;
  double most = 0;
  for (const glm::dvec2 corner : {glm::dvec2(0, 0), {k.width, 0}, {0, k.height}, {k.width, k.height}})
    most = std::max(most, std::acos(std::clamp(-unproject(k, corner).z, -1.0, 1.0)));
  return most;
}

// Max number of points of a pair, for this number of photographs.
std::size_t maxPairPoints(std::size_t photographs) {
  return std::clamp(kMaxTotalPoints / std::max<std::size_t>(photographs * kMaxNeighbours / 2, 1), kMinPairPoints,
                    kMaxPairPoints);
}

class Overlaps {
 public:
  explicit Overlaps(std::vector<PhotographWithDepth> around)
      : around_(std::move(around)), maxPairPoints_(maxPairPoints(around_.size())) {
    for (const PhotographWithDepth& a : around_) maxAxisAngle_.push_back(maxAxisAngle(a.camera->intrinsics));
  }

  bool mayOverlap(std::uint32_t a, std::uint32_t b) const {
    if (a == b) return false;
    return angleBetween(viewAxis(around_[a].camera->pose), viewAxis(around_[b].camera->pose)) <
           maxAxisAngle_[a] + maxAxisAngle_[b];
  }

  double distance(std::uint32_t a, std::uint32_t b) const {
    return glm::distance(around_[a].camera->pose.position, around_[b].camera->pose.position);
  }

  // Points of a that b shows too, evenly sampled.
  std::vector<OverlapPoint> between(std::uint32_t a, std::uint32_t b) const {
    std::vector<OverlapPoint> all, points;
    for (const glm::dvec2 pixel : gridOf(around_[a].camera->intrinsics))
      if (const auto inverse = sharedAt(around_[a], around_[b], pixel))
        all.push_back({a, b, worldRay(*around_[a].camera, pixel), *inverse});
    const std::size_t count = std::min(all.size(), maxPairPoints_);
    for (std::size_t i = 0; i < count; ++i) points.push_back(all[i * all.size() / count]);
    return points;
  }

 private:
  // Inverse distance from a of the point at `pixel`; nullopt if b does not show the point, or depth is unknown.
  static std::optional<double> sharedAt(const PhotographWithDepth& a, const PhotographWithDepth& b, glm::dvec2 pixel) {
    const Camera &from = *a.camera, &to = *b.camera;
    const glm::dvec3 ray = worldRay(from, pixel), shift = from.pose.position - to.pose.position;
    const auto seen = [&](double inverse) -> std::optional<glm::dvec2> {
      const auto at = project(to.intrinsics, glm::conjugate(to.pose.rotation) * (ray + inverse * shift));
      return at && isInside(to.intrinsics, *at) ? at : std::nullopt;
    };
    const double baseline = glm::length(shift), nearest = std::max(a.nearest, b.nearest);
    if (baseline <= 0 || (nearest >= 0 && baseline * nearest < 2 * kMaxParallax)) {
      const double middle = baseline > 0 ? nearest / 2 : 0;
      return seen(middle) ? std::optional(middle) : std::nullopt;
    }
    const auto inverse = inverseDistanceAt(a, pixel);
    if (!inverse) return std::nullopt;
    const auto at = seen(*inverse);
    if (!at) return std::nullopt;
    const auto there = inverseDistanceAt(b, *at);
    if (angleBetween(ray, ray + *inverse * shift) > kMaxRayAngle) return std::nullopt;
    const double expected = *inverse / glm::length(ray + *inverse * shift);
    if (!there || std::abs(*there - expected) > kDepthTolerance * std::max(*there, expected) + 1e-9)
      return std::nullopt;
    return inverse;
  }

  std::vector<PhotographWithDepth> around_;
  std::size_t maxPairPoints_;  // max points of a pair
  std::vector<double> maxAxisAngle_;
};

// For each photograph the inverse distances of the model's points that it observes.
std::vector<std::vector<double>> trackDistances(const std::vector<Photograph>& photographs, const PosedModel& model) {
  std::vector<std::vector<double>> inverse(photographs.size());
  for (const Track& track : model.tracks)
    for (const TrackObservation& o : track.observations)
      inverse[o.image].push_back(1 / glm::distance(track.position, photographs[o.image].camera.pose.position));
  return inverse;
}

}  // namespace

std::size_t maxOverlapPoints(std::size_t photographs) {
  const std::size_t others = photographs - std::min<std::size_t>(photographs, 1);
  return photographs * std::min(others, kMaxNeighbours) / 2 * maxPairPoints(photographs);
}

std::vector<OverlapPoint> overlapPoints(const std::vector<Photograph>& photographs, const PosedModel& model,
                                        const std::vector<PhotographDepth>& depths, const BuildJobs& jobs) {
  const auto count = std::uint32_t(photographs.size());
  const std::vector<std::vector<double>> tracks = trackDistances(photographs, model);
  std::vector<PhotographWithDepth> around(count);
  jobs.runAll("finding overlaps", count, 1e6,
              [&](std::size_t n) { around[n] = withDepth(photographs[n].camera, tracks[n], depths[n]); });
  const Overlaps overlaps(std::move(around));
  std::vector<std::vector<std::vector<OverlapPoint>>> found(count);
  jobs.runAll("finding overlaps", count, 1e6, [&](std::size_t n) {
    const auto a = std::uint32_t(n);
    std::vector<std::uint32_t> others;
    for (std::uint32_t b = 0; b < count; ++b)
      if (overlaps.mayOverlap(a, b)) others.push_back(b);
    std::ranges::stable_sort(others, {}, [&](std::uint32_t b) { return overlaps.distance(a, b); });
    if (others.size() > kMaxCandidates) others.resize(kMaxCandidates);
    for (const std::uint32_t b : others) {
      if (found[n].size() == kMaxNeighbours) break;
      std::vector<OverlapPoint> points = overlaps.between(std::min(a, b), std::max(a, b));
      if (points.size() >= kMinSharedPoints) found[n].push_back(std::move(points));
    }
  });
  std::set<std::pair<std::uint32_t, std::uint32_t>> known;
  std::vector<OverlapPoint> points;
  for (const auto& of : found)
    for (const std::vector<OverlapPoint>& pair : of)
      if (known.insert({pair[0].first, pair[0].second}).second) points.insert(points.end(), pair.begin(), pair.end());
  return points;
}

}  // namespace ibr
