// SPDX-License-Identifier: Apache-2.0

#include "author/sweep/depth_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "author/geometry/match_view.h"
#include "author/geometry/mean_frame.h"
#include "author/photographs/masks.h"

namespace ibr {
namespace {

constexpr int kMaxFatteningPx = 4;       // px: radius of the sweep's window plus smoothing
constexpr float kMinDepthStep = 3.0f;    // minimum step of a depth edge, levels
constexpr float kMinImageStep = 8.0f;    // minimum step of an image edge between neighbours, grey levels
constexpr float kEqualFactor = 1.1f;     // tolerance for the surface behind: of the foreground's difference …
constexpr float kNoise = 0.25f;          // … plus this many grey levels
constexpr float kBetterFactor = 0.7f;    // at an image edge: of the foreground's difference
constexpr int kRadius = 2;               // of the window, px
constexpr float kColourScale = 10.0f;    // grey levels that divide a pixel's weight by e
constexpr float kMaxDifference = 25.0f;  // grey levels: larger differences count as this one

float meanOf(std::span<const float> values) {
  return std::accumulate(values.begin(), values.end(), 0.0f) / float(std::max(values.size(), std::size_t(1)));
}

// Drops the value farthest from the mean: behind a silhouette one member may see the foreground.
std::span<float> withoutOutlier(std::span<float> values) {
  const float mean = meanOf(values);
  std::swap(*std::ranges::max_element(values, {}, [&](float v) { return std::abs(v - mean); }), values.back());
  return values.first(values.size() - 1);
}

class PhotoConsistency {
 public:
  PhotoConsistency(const Camera& frame, std::span<const SweepView> views, const SweepLevels& range)
      : views_(views), range_(range) {
    for (const SweepView& view : views) maps_.push_back(frameToMember(frame, view.camera));
  }

  // Difference between the members around the pixel at this level, grey levels.
  float difference(int x, int y, float level) const {
    const double inverseDepth = range_.at(double(level));
    const Seen centre = seen(x, y, inverseDepth);
    float total = 0, weight = 0;
    for (int v = y - kRadius; v <= y + kRadius; ++v)
      for (int u = x - kRadius; u <= x + kRadius; ++u) {
        const Seen here = seen(u, v, inverseDepth);
        if (here.members == 0) continue;
        const float alike = std::exp(-std::abs(here.mean - centre.mean) / kColourScale);
        total += alike * here.difference;
        weight += alike;
      }
    return weight > 0 ? total / weight : kMaxDifference;
  }

 private:
  struct Seen {
    int members = 0;
    float mean = 0, difference = 0;
  };

  Seen seen(int x, int y, double inverseDepth) const {
    std::array<float, kMaxMembers> value;
    Seen result;
    for (std::size_t i = 0; i < maps_.size(); ++i) {
      const ImageF& grey = views_[i].grey;
      const auto at = maps_[i]({x + 0.5, y + 0.5}, inverseDepth);
      if (!at || !(at->x >= 0.5 && at->y >= 0.5 && at->x < grey.width - 0.5 && at->y < grey.height - 0.5)) continue;
      if (isIgnored(views_[i].mask, *at)) continue;
      const auto px = float(at->x - 0.5), py = float(at->y - 0.5);
      const int ix = std::min(int(px), grey.width - 2), iy = std::min(int(py), grey.height - 2);
      const float fx = px - float(ix), fy = py - float(iy);
      const float* const p = &grey.values[std::size_t(iy) * std::size_t(grey.width) + std::size_t(ix)];
      const float top = p[0] + fx * (p[1] - p[0]);
      const float low = p[grey.width] + fx * (p[grey.width + 1] - p[grey.width]);
      value[std::size_t(result.members++)] = top + fy * (low - top);
    }
    if (result.members < 2) return {};
    std::span<float> members = std::span(value).first(std::size_t(result.members));
    if (members.size() >= 3) members = withoutOutlier(members);
    result.mean = meanOf(members);
    for (const float v : members)
      result.difference += std::min(std::abs(v - result.mean), kMaxDifference) / float(members.size());
    return result;
  }

  std::span<const SweepView> views_;
  const SweepLevels& range_;
  std::vector<FrameToMember> maps_;
};

}  // namespace

void trimForegrounds(const Camera& frame, std::span<const SweepView> views, const SweepLevels& range,
                     const ImageF& guide, ImageF& level) {
  const PhotoConsistency consistency(frame, views, range);
  // Returns the farthest of the neighbours' levels that the pixel may take.
  const auto trimmed = [&](const ImageF& before, int x, int y) {
    const float here = before.pixel(x, y)[0];
    float best = here;
    std::optional<float> own;
    for (const auto& [u, v] : {std::pair{x - 1, y}, {x + 1, y}, {x, y - 1}, {x, y + 1}}) {
      if (u < 0 || v < 0 || u >= before.width || v >= before.height) continue;
      const float there = before.pixel(u, v)[0];
      if (there > here - kMinDepthStep || there >= best) continue;
      const bool border = std::abs(guide.pixel(u, v)[0] - guide.pixel(x, y)[0]) > kMinImageStep;
      if (!own) own = consistency.difference(x, y, here);
      const float behind = consistency.difference(x, y, there);
      if (border ? behind <= kBetterFactor * *own : behind <= kEqualFactor * *own + kNoise) best = there;
    }
    return best;
  };
  for (int round = 0; round < kMaxFatteningPx; ++round) {
    const ImageF before = level;
    for (int y = 0; y < level.height; ++y)
      for (int x = 0; x < level.width; ++x) level.pixel(x, y)[0] = trimmed(before, x, y);
  }
}

}  // namespace ibr
