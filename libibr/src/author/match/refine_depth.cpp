// SPDX-License-Identifier: Apache-2.0
#include "author/match/refine_depth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "author/photographs/masks.h"

namespace ibr {
namespace {

constexpr int kRadius = 5, kPatchPixels = (2 * kRadius + 1) * (2 * kRadius + 1), kMinPixels = kPatchPixels / 3;  // px
constexpr double kMaxPlaneSteps = 1.5;     // of plane, sweep steps
constexpr double kMaxMotionPx = 2.0;       // maximum change of depth, in px between members
constexpr double kNoise = 4.0;             // grey levels; with kPriorDeviationPx the weight of the dense depth
constexpr double kPriorDeviationPx = 0.5;  // px, one standard deviation of the dense depth
constexpr int kMaxIterations = 4;

}  // namespace

struct DepthRefiner::Patch {
  int count = 0;
  std::array<glm::dvec2, kPatchPixels> pixel;
  std::array<double, kPatchPixels> inverseDepth;
  double perPixel = 0;  // change of inverse depth that moves members by 1 px relative to each other
};

DepthRefiner::DepthRefiner(std::span<const MatchView> views, const DenseMatch& match) : match_(match) {
  for (const MatchView& view : views) {
    maps_.push_back(frameToMember(match.frame, view.camera));
    masks_.push_back(view.mask);
    ImageF& grey = grey_.emplace_back(view.picture.width, view.picture.height, 1);
    for (std::size_t p = 0; p < grey.values.size(); ++p) {
      const std::uint8_t* const rgb = &view.picture.values[3 * p];
      grey.values[p] = 0.299f * float(rgb[0]) + 0.587f * float(rgb[1]) + 0.114f * float(rgb[2]);
    }
  }
}

// True if all members see the point unmasked, also after a small change of its depth.
bool DepthRefiner::seen(glm::dvec2 pixel, double inverseDepth) const {
  for (std::size_t i = 0; i < maps_.size(); ++i) {
    constexpr double kMargin = kMaxMotionPx + 1;
    const auto at = maps_[i](pixel, inverseDepth);
    if (!at || at->x < kMargin || at->y < kMargin || at->x > grey_[i].width - kMargin ||
        at->y > grey_[i].height - kMargin || isIgnored(masks_[i], *at))
      return false;
  }
  return true;
}

bool DepthRefiner::gather(int x, int y, Patch& patch) const {
  const ImageF& depth = match_.inverseDepth;
  const int x0 = std::max(x - kRadius, 0), x1 = std::min(x + kRadius, depth.width - 1);
  const int y0 = std::max(y - kRadius, 0), y1 = std::min(y + kRadius, depth.height - 1);
  const double here = depth.pixel(x, y)[0];
  double motion = 0;
  std::vector<glm::dvec2> move;
  for (const FrameToMember& map : maps_) {
    const glm::dvec3 h = map.homogeneous({x + 0.5, y + 0.5}, here);
    move.emplace_back((map.b.x - h.x / h.z * map.b.z) / h.z, (map.b.y - h.y / h.z * map.b.z) / h.z);
    for (const glm::dvec2 other : move) motion = std::max(motion, glm::distance(other, move.back()));
  }
  patch.perPixel = std::max(1.0 / motion, double(match_.inverseDepthStep));
  const double limit = kMaxPlaneSteps * patch.perPixel;
  // Slope of the plane from pixels of similar depth: least squares without cross term, since the window
  // is nearly symmetric.
  double sx = 0, sy = 0, sxx = 0, syy = 0;
  for (int v = y0; v <= y1; ++v)
    for (int u = x0; u <= x1; ++u) {
      const double off = double(depth.pixel(u, v)[0]) - here;
      if (std::abs(off) > 4 * limit) continue;
      sx += (u - x) * off, sxx += (u - x) * (u - x);
      sy += (v - y) * off, syy += (v - y) * (v - y);
    }
  const double slopeX = sxx > 0 ? sx / sxx : 0, slopeY = syy > 0 ? sy / syy : 0;
  patch.count = 0;
  for (int v = y0; v <= y1; ++v)
    for (int u = x0; u <= x1; ++u) {
      const double plane = here + slopeX * (u - x) + slopeY * (v - y);
      if (!match_.good.pixel(u, v)[0] || std::abs(double(depth.pixel(u, v)[0]) - plane) > limit ||
          !seen({u + 0.5, v + 0.5}, plane))
        continue;
      patch.pixel[std::size_t(patch.count)] = {u + 0.5, v + 0.5};
      patch.inverseDepth[std::size_t(patch.count++)] = plane;
    }
  return patch.count >= kMinPixels && motion > 0;
}

// Returns the mean square deviation between the members, grey²; infinite if a member does not see the patch. `step`
// receives the change of inverse depth that minimises the error, to first order.
double DepthRefiner::error(const Patch& patch, double change, double* step) const {
  const std::size_t d = grey_.size();
  std::array<std::array<float, kPatchPixels>, kMaxMembers> value, slope;
  double spread = 0;
  for (std::size_t i = 0; i < d; ++i) {
    const ImageF& grey = grey_[i];
    double sum = 0, square = 0, sumSlope = 0;
    for (int k = 0; k < patch.count; ++k) {
      const glm::dvec3 h =
          maps_[i].homogeneous(patch.pixel[std::size_t(k)], patch.inverseDepth[std::size_t(k)] + change);
      const double px = h.x / h.z - 0.5, py = h.y / h.z - 0.5;
      if (!(h.z > 0) || !(px >= 0) || !(py >= 0) || !(px < grey.width - 1) || !(py < grey.height - 1))
        return std::numeric_limits<double>::infinity();
      const int ix = int(px), iy = int(py);
      const float fx = float(px - ix), fy = float(py - iy);
      const float* const p = &grey.values[std::size_t(iy) * std::size_t(grey.width) + std::size_t(ix)];
      const float a = p[0], b = p[1], c = p[grey.width], e = p[grey.width + 1];
      const float g = a + fx * (b - a) + fy * (c - a) + fx * fy * (a - b - c + e);
      const float gx = b - a + fy * (a - b - c + e), gy = c - a + fx * (a - b - c + e);
      const glm::dvec3 move = maps_[i].b;
      const double dx = (move.x - h.x / h.z * move.z) / h.z, dy = (move.y - h.y / h.z * move.z) / h.z;
      value[i][std::size_t(k)] = g;
      slope[i][std::size_t(k)] = float(double(gx) * dx + double(gy) * dy);
      sum += double(g);
      square += double(g) * double(g);
      sumSlope += double(slope[i][std::size_t(k)]);
    }
    const double n = patch.count, mean = sum / n;
    const double own = std::sqrt(std::max(square / n - mean * mean, 1.0));
    if (i == 0) spread = own;
    const auto gain = float(std::clamp(spread / own, 0.5, 2.0));
    for (int k = 0; k < patch.count; ++k) {
      value[i][std::size_t(k)] = gain * (value[i][std::size_t(k)] - float(mean));
      slope[i][std::size_t(k)] = gain * (slope[i][std::size_t(k)] - float(sumSlope / n));
    }
  }
  double error = 0, along = 0, curvature = 0;
  for (int k = 0; k < patch.count; ++k) {
    float mean = 0, meanSlope = 0;
    for (std::size_t i = 0; i < d; ++i) {
      mean += value[i][std::size_t(k)] / float(d);
      meanSlope += slope[i][std::size_t(k)] / float(d);
    }
    for (std::size_t i = 0; i < d; ++i) {
      const double r = double(value[i][std::size_t(k)] - mean), s = double(slope[i][std::size_t(k)] - meanSlope);
      error += r * r;
      along += r * s;
      curvature += s * s;
    }
  }
  const double deviation = kPriorDeviationPx * patch.perPixel, prior = kNoise * kNoise / (deviation * deviation);
  if (step) *step = -(along + prior * change) / (curvature + prior);
  return (error + prior * change * change) / (patch.count * double(d));
}

double DepthRefiner::at(int x, int y) const {
  const double dense = match_.inverseDepth.pixel(x, y)[0];
  Patch patch;
  if (!gather(x, y, patch)) return dense;
  double change = 0, step = 0;
  double before = error(patch, 0, &step);
  for (int round = 0; round < kMaxIterations && std::isfinite(before); ++round) {
    const double next = change + step;
    if (std::abs(next) > kMaxMotionPx * patch.perPixel) break;
    const double after = error(patch, next, &step);
    if (!(after < before)) break;
    change = next;
    before = after;
  }
  return std::max(dense + change, 0.0);
}

}  // namespace ibr
