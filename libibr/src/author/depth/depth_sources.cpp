// SPDX-License-Identifier: Apache-2.0
#include "author/depth/depth_sources.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numbers>

namespace ibr {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr int kGrid = 10;                  // cells per side, over the image
constexpr double kUnobservedWeight = 0.3;  // weight of a track that only one of the two observes
constexpr double kMinGain = 1e-9;
// Weight of a parallax: 1 at `best`, a Gaussian with different standard deviations below and above. Radians.
struct Parallax {
  double best, below, above;
  double weight(double angle) const {
    const double off = (angle - best) / (angle < best ? below : above);
    return std::exp(-0.5 * off * off);
  }
};
constexpr Parallax kNear{6 * kDegree, 3 * kDegree, 12 * kDegree};
constexpr Parallax kWide{18 * kDegree, 6 * kDegree, 7 * kDegree};

struct TrackPoint {
  glm::dvec3 position;
  std::uint32_t track;
  double share;  // weight of the track after equalisation over the grid
};

std::optional<glm::dvec2> pixelOf(const Camera& camera, const glm::dvec3& point) {
  const auto at = project(camera.intrinsics, glm::conjugate(camera.pose.rotation) * (point - camera.pose.position));
  const bool inside =
      at && at->x >= 0 && at->y >= 0 && at->x <= camera.intrinsics.width && at->y <= camera.intrinsics.height;
  return inside ? at : std::nullopt;
}

std::vector<TrackPoint> trackPoints(const PosedModel& model, const Camera& camera,
                                    const std::vector<std::uint32_t>& tracks) {
  std::array<int, kGrid * kGrid> count{};
  std::vector<std::size_t> cell;
  std::vector<TrackPoint> places;
  for (const std::uint32_t t : tracks) {
    const glm::dvec3& position = model.tracks[t].position;
    const auto at = pixelOf(camera, position);
    if (!at) continue;
    const auto along = [](double x, int side) { return std::min(int(kGrid * x / side), kGrid - 1); };
    cell.push_back(std::size_t(along(at->y, camera.intrinsics.height) * kGrid + along(at->x, camera.intrinsics.width)));
    ++count[cell.back()];
    places.push_back({position, t, 0});
  }
  for (std::size_t p = 0; p < places.size(); ++p) places[p].share = 1.0 / count[cell[p]];
  return places;
}

}  // namespace

std::vector<std::uint32_t> depthSources(const PosedModel& model, std::span<const DepthView> views,
                                        std::span<const std::vector<std::uint32_t>> tracksOf, std::uint32_t view) {
  const std::vector<TrackPoint> places = trackPoints(model, views[view].camera, tracksOf[views[view].node]);
  const glm::dvec3 own = views[view].camera.pose.position;
  std::vector<std::vector<float>> near(views.size()), wide(views.size());  // weights of the tracks' points
  for (std::uint32_t j = 0; j < views.size(); ++j) {
    const Camera& camera = views[j].camera;
    const glm::dvec3 other = camera.pose.position;
    if (other == own) continue;
    near[j].assign(places.size(), 0);
    wide[j].assign(places.size(), 0);
    for (std::size_t p = 0; p < places.size(); ++p) {
      const TrackPoint& place = places[p];
      if (!pixelOf(camera, place.position)) continue;
      const glm::dvec3 a = own - place.position, b = other - place.position;
      const double ra = glm::length(a), rb = glm::length(b);
      const double angle = std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
      const bool observed = std::ranges::binary_search(tracksOf[views[j].node], place.track);
      const double weight = std::min(ra / rb, rb / ra) * (observed ? 1.0 : kUnobservedWeight);
      near[j][p] = float(weight * kNear.weight(angle));
      wide[j][p] = float(weight * kWide.weight(angle));
    }
  }
  std::vector<std::uint32_t> chosen;
  const auto choose = [&](const std::vector<std::vector<float>>& weights, std::size_t most) {
    std::vector<float> sum(places.size(), 0);
    for (std::size_t round = 0; round < most; ++round) {
      double best = kMinGain;
      std::uint32_t which = 0;
      bool found = false;
      for (std::uint32_t j = 0; j < weights.size(); ++j) {
        if (weights[j].empty() || std::ranges::find(chosen, j) != chosen.end()) continue;
        double gain = 0;
        for (std::size_t p = 0; p < places.size(); ++p)
          if (weights[j][p] > 0)
            gain += places[p].share * (std::sqrt(double(sum[p]) + double(weights[j][p])) - std::sqrt(double(sum[p])));
        if (gain > best) {
          best = gain;
          which = j;
          found = true;
        }
      }
      if (!found) return;
      chosen.push_back(which);
      for (std::size_t p = 0; p < places.size(); ++p) sum[p] += weights[which][p];
    }
  };
  choose(near, kNearSources);
  choose(wide, kWideSources);
  return chosen;
}

}  // namespace ibr
