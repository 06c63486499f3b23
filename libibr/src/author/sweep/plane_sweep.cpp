// SPDX-License-Identifier: Apache-2.0
#include "author/sweep/plane_sweep.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <utility>

#include "author/geometry/mean_frame.h"

namespace ibr {
namespace {

constexpr int kBlock = 16;  // levels that are matched before transposing them to lie side by side at each pixel
// Cost below which a slanted plane is accepted (a correlation of 0.25): in areas without texture, as the sky, planes
// would otherwise extend without limit.
constexpr std::uint8_t kMaxBelievedCost = 90;
constexpr double kMinSlant = 0.3;  // of planes, levels per pixel

// Homography of a member for a plane of inverse depth n·(x, y, 1), as in PlaneMaps.
glm::dmat3 through(const FrameToMember& map, glm::dvec3 n) {
  return map.a + glm::outerProduct(map.b, n);
}

class Sweep {
 public:
  Sweep(const Camera& frame, std::span<const SweepView> views, const SweepLevels& range)
      : views_(views),
        range_(range),
        width_(frame.intrinsics.width),
        height_(frame.intrinsics.height),
        levels_(range.count()),
        pixels_(std::size_t(width_) * std::size_t(height_)),
        warped_(views.size(), WarpedView(width_, height_)),
        correlation_(int(views.size()), width_, height_),
        best_(pixels_, 255),
        volume_{width_, height_, levels_, {}, ImageF(width_, height_, 1), {}} {
    volume_.cost.resize(pixels_ * std::size_t(levels_));
    for (const SweepView& view : views) maps_.push_back(frameToMember(frame, view.camera));
  }

  /// Matches planes that face the frame: one per level.
  void facing() {
    std::vector<std::uint8_t> block(pixels_ * kBlock);
    for (int base = 0; base < levels_; base += kBlock) {
      const int count = std::min(kBlock, levels_ - base);
      for (int k = 0; k < count; ++k) {
        std::uint8_t* const cost = &block[std::size_t(k) * pixels_];
        match({0, 0, range_.inverseDepth[std::size_t(base + k)]}, {0, 0, double(base + k) / (levels_ - 1)}, cost);
        for (std::size_t p = 0; p < pixels_; ++p) remember(p, cost[p]);
      }
      for (std::size_t p = 0; p < pixels_; ++p)
        for (int k = 0; k < count; ++k) at(p, base + k) = block[std::size_t(k) * pixels_ + p];
    }
  }

  /// Matches a slanted plane and parallel ones, offset by steps of inverse depth. A level between two of these planes
  /// takes their interpolated cost if it is lower than the level's own.
  void along(glm::dvec3 plane) {
    std::vector<std::int16_t>& on = volume_.planes.emplace_back(pixels_, kNoLevel);
    std::vector<std::uint8_t> cost(pixels_), before(pixels_), least(pixels_, 255);
    const double nearest = range_.inverseDepth.back(), range = (levels_ - 1) * range_.step;
    for (int k = -kPlaneReach; k <= kPlaneReach; ++k) {
      const glm::dvec3 n = plane + glm::dvec3(0, 0, k * range_.step);
      match(n, n / range + glm::dvec3(0, 0, 1.0 - nearest / range), cost.data());
      for (int y = 0; y < height_; ++y)
        for (int x = 0; x < width_; ++x) {
          const double inverseDepth = glm::dot(n, glm::dvec3(x + 0.5, y + 0.5, 1.0));
          if (!(inverseDepth >= range_.evenFrom && inverseDepth < nearest)) continue;
          const double level = levels_ - 1 - (nearest - inverseDepth) / range_.step;
          if (level < 1) continue;
          const std::size_t p = std::size_t(y) * std::size_t(width_) + std::size_t(x);
          remember(p, cost[p]);
          least[p] = std::min(least[p], cost[p]);
          if (k == 0) on[p] = std::int16_t(std::lround(level));
          if (k == -kPlaneReach) continue;
          const int below = int(level);  // between this plane and the previous one
          const float part = float(level - below);
          const float between = float(cost[p]) + part * (float(before[p]) - float(cost[p]));
          if (between < float(kMaxBelievedCost)) at(p, below) = std::min(at(p, below), std::uint8_t(between + 0.5f));
        }
      std::swap(cost, before);
    }
    for (std::size_t p = 0; p < pixels_; ++p)
      if (least[p] >= kMaxBelievedCost) on[p] = kNoLevel;
  }

  CostVolume take() { return std::move(volume_); }

 private:
  std::uint8_t& at(std::size_t pixel, int level) {
    return volume_.cost[pixel * std::size_t(levels_) + std::size_t(level)];
  }

  void match(glm::dvec3 plane, glm::dvec3 nearness, std::uint8_t* cost) {
    for (std::size_t i = 0; i < views_.size(); ++i) warp(views_[i], through(maps_[i], plane), warped_[i]);
    correlation_.run(warped_, nearness, cost);
  }

  void remember(std::size_t p, std::uint8_t cost) {
    if (cost >= best_[p]) return;
    best_[p] = cost;
    float sum = 0, all = 0, count = 0;
    for (const WarpedView& w : warped_) {
      all += w.grey.values[p];
      if (!w.ignored.empty() && w.ignored[p]) continue;
      sum += w.grey.values[p];
      count += 1;
    }
    if (count == 0) sum = all, count = float(warped_.size());
    volume_.guide.values[p] = sum / (WarpedView::kUnits * count) + 128.0f;
  }

  std::span<const SweepView> views_;
  const SweepLevels& range_;
  int width_, height_, levels_;
  std::size_t pixels_;
  std::vector<FrameToMember> maps_;
  std::vector<WarpedView> warped_;
  WindowCorrelation correlation_;
  std::vector<std::uint8_t> best_;  // cost of the match that the guide shows
  CostVolume volume_;
};

}  // namespace

CostVolume planeSweep(const Camera& frame, std::span<const SweepView> views, const SweepLevels& levels,
                      std::span<const glm::dvec3> planes) {
  Sweep sweep(frame, views, levels);
  sweep.facing();
  for (const glm::dvec3& plane : planes)
    if (glm::length(glm::dvec2(plane)) >= kMinSlant * levels.step) sweep.along(plane);
  return sweep.take();
}

}  // namespace ibr
