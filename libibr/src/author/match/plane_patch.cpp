// SPDX-License-Identifier: Apache-2.0
#include "author/match/plane_patch.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace ibr {
namespace {

constexpr int kRadius = 4;
constexpr std::size_t kSize = (2 * kRadius + 1) * (2 * kRadius + 1);
constexpr double kNoiseVariance = 9.0;  // grey²: noise variance, added to each window's variance
constexpr int kSteps = 8;
constexpr double kConvergencePx = 0.005;  // px: smaller steps end the iteration

}  // namespace

struct PlanePatches::Window {
  std::array<double, kSize> value, slopeX, slopeY;  // of the image, where the window's pixels are seen
  double mean = 0, variance = 0;
};

PlanePatches::PlanePatches(std::span<const ImageF> grey, std::span<const Camera> cameras, bool posed)
    : grey_(grey), posed_(posed) {
  for (const Camera& camera : cameras) maps_.push_back(frameToMember(cameras[0], camera));
}

// Samples the window around `first` of the first member, mapped by the plane and shifted so that its
// centre lies at `centre`.
bool PlanePatches::sample(std::size_t member, const glm::dmat3& plane, glm::dvec2 first, glm::dvec2 centre,
                          Window& window) const {
  const ImageF& grey = grey_[member];
  const glm::dvec3 middle = plane * glm::dvec3(first, 1.0);
  if (!(middle.z > 0)) return false;
  const glm::dvec2 shift = centre - glm::dvec2(middle) / middle.z;
  double sum = 0, square = 0;
  std::size_t k = 0;
  for (int dy = -kRadius; dy <= kRadius; ++dy)
    for (int dx = -kRadius; dx <= kRadius; ++dx, ++k) {
      const glm::dvec3 q = plane * glm::dvec3(first.x + dx, first.y + dy, 1.0);
      if (!(q.z > 0)) return false;
      const double px = q.x / q.z + shift.x - 0.5, py = q.y / q.z + shift.y - 0.5;
      if (!(px >= 0) || !(py >= 0) || !(px < grey.width - 1) || !(py < grey.height - 1)) return false;
      const int ix = int(px), iy = int(py);
      const double fx = px - ix, fy = py - iy;
      const float* const p = &grey.values[std::size_t(iy) * std::size_t(grey.width) + std::size_t(ix)];
      const double a = double(p[0]), b = double(p[1]), c = double(p[grey.width]), e = double(p[grey.width + 1]);
      window.value[k] = a + fx * (b - a) + fy * (c - a) + fx * fy * (a - b - c + e);
      window.slopeX[k] = b - a + fy * (a - b - c + e);
      window.slopeY[k] = c - a + fx * (a - b - c + e);
      sum += window.value[k];
      square += window.value[k] * window.value[k];
    }
  window.mean = sum / double(kSize);
  window.variance = std::max(square / double(kSize) - window.mean * window.mean, 0.0);
  return true;
}

double PlanePatches::correlation(const PlaneMaps& plane, std::span<const glm::dvec2> at) const {
  Window first, other;
  if (!sample(0, plane.to[0], at[0], at[0], first)) return -1;
  double least = 1;
  for (std::size_t i = 1; i < grey_.size(); ++i) {
    if (!sample(i, plane.to[i], at[0], at[i], other)) return -1;
    double covariance = 0;
    for (std::size_t k = 0; k < kSize; ++k) covariance += (first.value[k] - first.mean) * (other.value[k] - other.mean);
    least = std::min(least, covariance / double(kSize) /
                                std::sqrt((first.variance + kNoiseVariance) * (other.variance + kNoiseVariance)));
  }
  return least;
}

double PlanePatches::align(const PlaneMaps& plane, std::span<glm::dvec2> at, double reach) const {
  const std::size_t d = grey_.size();
  std::array<glm::dvec2, kMaxMembers> here{}, start{};
  std::copy(at.begin(), at.end(), here.begin());
  start = here;
  double best = correlation(plane, at);
  if (best <= 0) return best;
  Window first, other;
  if (!sample(0, plane.to[0], at[0], at[0], first)) return best;
  const std::span<glm::dvec2> moved(here.data(), d);
  for (int step = 0; step < kSteps; ++step) {
    double along = 0, curvature = 0, largest = 0;  // with poses: of one change of inverse depth
    std::array<glm::dvec2, kMaxMembers> direction{}, change{};
    for (std::size_t i = 1; i < d; ++i) {
      if (!sample(i, plane.to[i], at[0], here[i], other)) return best;
      const double gain =
          std::clamp(std::sqrt((first.variance + kNoiseVariance) / (other.variance + kNoiseVariance)), 0.25, 4.0);
      double xx = 1e-6, xy = 0, yy = 1e-6, rx = 0, ry = 0;
      glm::dvec2 meanSlope(0.0);
      for (std::size_t k = 0; k < kSize; ++k) meanSlope += glm::dvec2(other.slopeX[k], other.slopeY[k]) / double(kSize);
      for (std::size_t k = 0; k < kSize; ++k) {
        const double sx = gain * (other.slopeX[k] - meanSlope.x), sy = gain * (other.slopeY[k] - meanSlope.y);
        const double r = first.value[k] - first.mean - gain * (other.value[k] - other.mean);
        xx += sx * sx, xy += sx * sy, yy += sy * sy;
        rx += sx * r, ry += sy * r;
      }
      if (posed_) {
        // Motion of the point for a growing inverse depth: along the epipolar line, to the first member's epipole.
        const glm::dvec3 infinite = maps_[i].homogeneous(at[0], 0);
        direction[i] = (glm::dvec2(maps_[i].b) - here[i] * maps_[i].b.z) / infinite.z;
        const glm::dvec2 m = direction[i];
        curvature += xx * m.x * m.x + 2 * xy * m.x * m.y + yy * m.y * m.y;
        along += rx * m.x + ry * m.y;
      } else {
        const double determinant = xx * yy - xy * xy;
        if (!(determinant > 1e-6 * xx * yy)) return best;
        change[i] = {(yy * rx - xy * ry) / determinant, (xx * ry - xy * rx) / determinant};
      }
    }
    for (std::size_t i = 1; i < d; ++i) {
      if (posed_) change[i] = curvature > 0 ? direction[i] * (along / curvature) : glm::dvec2(0.0);
      if (!std::isfinite(change[i].x + change[i].y)) return best;
      here[i] += change[i];
      largest = std::max(largest, glm::length(change[i]));
      if (glm::distance(here[i], start[i]) > reach) return best;
    }
    const double now = correlation(plane, moved);
    if (!(now > best)) break;
    best = now;
    std::copy(moved.begin(), moved.end(), at.begin());
    if (largest < kConvergencePx) break;
  }
  return best;
}

}  // namespace ibr
