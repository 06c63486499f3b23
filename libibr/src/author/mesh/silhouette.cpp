// SPDX-License-Identifier: Apache-2.0
#include "author/mesh/silhouette.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "author/photographs/masks.h"
#include "base/bilinear.h"

namespace ibr {
namespace {

constexpr int kRadius = 6;                  // neighbourhood for a surface's plane, px
constexpr double kMaxSurfaceLevels = 3;     // maximum difference from one pixel's depth, sweep levels
constexpr int kMinPixels = 12;              // minimum number of pixels for a plane
constexpr double kMinApartLevels = 2;       // minimum distance of a plane from another surface, sweep levels
constexpr double kJumpPx = 2.5;             // minimum parallax between members of two surfaces, px
constexpr double kStep = 0.5;               // px along a segment
constexpr double kJumpWidthPx = 2.0;        // px within which …
constexpr double kJumpShare = 0.5;          // … this share of the change happens at a jump
constexpr double kMaxJumpDistancePx = 5.0;  // maximum distance from the depth's jump to the colours', px
constexpr double kSampleOffsetPx = 1.0;     // distance to either side at which colours are compared, px
constexpr double kMinContrast = 12.0;       // minimum contrast of a border, grey levels per channel, mean over members
constexpr double kMinPart = 0.05;

}  // namespace

double SurfaceSample::at(glm::dvec2 other, double most) const {
  return std::max(inverseDepth + std::clamp(glm::dot(slope, other - pixel), -most, most), 0.0);
}

SilhouetteFinder::SilhouetteFinder(std::span<const MatchView> views, const DenseMatch& match)
    : views_(views), match_(match) {
  for (const MatchView& view : views) maps_.push_back(frameToMember(match.frame, view.camera));
}

SurfaceSample SilhouetteFinder::surface(glm::dvec2 pixel, double inverseDepth) const {
  const ImageF& depth = match_.inverseDepth;
  const int x = std::clamp(int(pixel.x), 0, depth.width - 1), y = std::clamp(int(pixel.y), 0, depth.height - 1);
  const double limit = kMaxSurfaceLevels * double(match_.inverseDepthStep), here = double(depth.pixel(x, y)[0]);
  double n = 0, sx = 0, sy = 0, sxx = 1e-3, sxy = 0, syy = 1e-3, sw = 0, sxw = 0, syw = 0;
  for (int v = std::max(y - kRadius, 0); v <= std::min(y + kRadius, depth.height - 1); ++v)
    for (int u = std::max(x - kRadius, 0); u <= std::min(x + kRadius, depth.width - 1); ++u) {
      const double off = double(depth.pixel(u, v)[0]) - here;
      if (std::abs(off) > limit) continue;
      const double dx = u - x, dy = v - y;
      n += 1, sx += dx, sy += dy, sxx += dx * dx, sxy += dx * dy, syy += dy * dy;
      sw += off, sxw += dx * off, syw += dy * off;
    }
  SurfaceSample sample{pixel, inverseDepth};
  if (n < kMinPixels) return sample;
  const double cxx = sxx - sx * sx / n, cyy = syy - sy * sy / n, cxy = sxy - sx * sy / n;
  const double cxw = sxw - sx * sw / n, cyw = syw - sy * sw / n, determinant = cxx * cyy - cxy * cxy;
  if (determinant > 1e-6 * cxx * cyy)
    sample.slope = glm::dvec2(cxw * cyy - cyw * cxy, cyw * cxx - cxw * cxy) / determinant;
  return sample;
}

double SilhouetteFinder::maxExtrapolation() const {
  return kMaxSurfaceLevels * double(match_.inverseDepthStep);
}

double SilhouetteFinder::parallax(glm::dvec2 pixel, double a, double b) const {
  double largest = 0;
  std::vector<glm::dvec2> moved;
  for (const FrameToMember& map : maps_) {
    const auto atA = map(pixel, a), atB = map(pixel, b);
    if (!atA || !atB) continue;
    moved.push_back(*atB - *atA);
    for (const glm::dvec2& other : moved) largest = std::max(largest, glm::distance(other, moved.back()));
  }
  return largest;
}

bool SilhouetteFinder::apart(const SurfaceSample& a, const SurfaceSample& b) const {
  const double limit = kMinApartLevels * double(match_.inverseDepthStep), most = maxExtrapolation();
  return std::abs(a.at(b.pixel, most) - b.inverseDepth) > limit &&
         std::abs(b.at(a.pixel, most) - a.inverseDepth) > limit &&
         parallax(a.pixel, a.inverseDepth, b.inverseDepth) > kJumpPx;
}

// Returns the colour difference of two points at the near surface's depth: mean over channels and members.
double SilhouetteFinder::contrast(glm::dvec2 inside, glm::dvec2 outside, double inverseDepth) const {
  double sum = 0;
  for (std::size_t i = 0; i < maps_.size(); ++i) {
    const auto a = maps_[i](inside, inverseDepth), b = maps_[i](outside, inverseDepth);
    if (!a || !b || isIgnored(views_[i].mask, *a) || isIgnored(views_[i].mask, *b)) continue;
    const glm::dvec3 difference = glm::abs(bilinear(views_[i].picture, *a) - bilinear(views_[i].picture, *b));
    sum += (difference.x + difference.y + difference.z) / 3;
  }
  return sum / double(maps_.size());
}

std::optional<double> SilhouetteFinder::between(const SurfaceSample& near, const SurfaceSample& far) const {
  const glm::dvec2 way = far.pixel - near.pixel;
  const double length = glm::length(way), change = near.inverseDepth - far.inverseDepth;
  if (!(change > 0) || length < 2 * kStep || parallax(near.pixel, far.inverseDepth, near.inverseDepth) < kJumpPx)
    return std::nullopt;
  const ImageF& depth = match_.inverseDepth;
  const int steps = int(std::ceil(length / kStep));
  const auto place = [&](double part) { return near.pixel + part * way; };
  std::vector<double> along;
  for (int k = 0; k <= steps; ++k) {
    const glm::dvec2 p = place(double(k) / steps);
    along.push_back(
        double(depth.pixel(std::clamp(int(p.x), 0, depth.width - 1), std::clamp(int(p.y), 0, depth.height - 1))[0]));
  }
  const int width = std::min(steps, int(kJumpWidthPx / kStep));
  int jump = 0;
  double largest = 0;
  for (int k = 0; k + width <= steps; ++k)
    if (const double drop = along[std::size_t(k)] - along[std::size_t(k + width)]; drop > largest)
      largest = drop, jump = k;
  if (largest < kJumpShare * change) return std::nullopt;
  const double middle = (jump + 0.5 * width) / steps;

  const double reach = kMaxJumpDistancePx / length;
  double best = middle, strongest = kMinContrast;
  for (double part = std::max(middle - reach, kMinPart); part <= std::min(middle + reach, 1 - kMinPart);
       part += 0.5 * kStep / length) {
    const double off = (part - middle) / reach, aside = kSampleOffsetPx / length;
    const double found = contrast(place(part - aside), place(part + aside), near.at(place(part), maxExtrapolation())) *
                         (1 - 0.5 * off * off);
    if (found > strongest) strongest = found, best = part;
  }
  return std::clamp(best, kMinPart, 1 - kMinPart);
}

}  // namespace ibr
