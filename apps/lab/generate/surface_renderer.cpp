// SPDX-License-Identifier: Apache-2.0
#include "lab/generate/surface_renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <optional>

#include "base/check.h"
#include "base/parallel.h"
#include "base/srgb.h"

namespace ibr {
namespace {

constexpr double kNearest = 0.02, kFarthest = 1000;  // m
constexpr float kLevelBias = -0.5f;                  // of mip levels: several samples a pixel allow for more detail

// A linear function of the pixel: dot(coefficients, (x, y, 1)).
using Linear = glm::dvec3;

float at(const Linear& f, double x, double y) {
  return float(f.x * x + f.y * y + f.z);
}

// Narrows [first, last) to the pixels of a row for which slope · x + start >= 0.
void narrow(double slope, double start, double& first, double& last) {
  if (slope > 0)
    first = std::max(first, -start / slope);
  else if (slope < 0)
    last = std::min(last, -start / slope);
  else if (start < 0)
    last = first;
}

}  // namespace

// For a surface (origin o, axes u and v, normal n) and a camera at p, a pixel's ray d has depth 1 along the axis, and
// its components along n, u and v are linear in the pixel. The ray meets the surface's plane at the depth 1 / w with
// w = n·d / n·(o − p), at u·(p − o) + (u·d) / w, and likewise for v.
struct SurfaceRenderer::Projected {
  std::uint16_t surface;
  Linear w, u, v;        // u and v: of the point, times w
  float texelsPerPixel;  // texels per pixel at w = 1, squared
};

struct SurfaceRenderer::Visible {
  std::vector<Projected> projected;
  Image<std::uint16_t> index;  // into `projected`, plus 1
  ImageF inverseDepth;
};

SurfaceRenderer::SurfaceRenderer(std::vector<Surface> surfaces, double density, int threads,
                                 const std::function<bool(std::size_t)>& report)
    : surfaces_(std::move(surfaces)), density_(density) {
  check(surfaces_.size() < 65535, ErrorCode::invalidInput, "{} surfaces are too many", surfaces_.size());
  std::vector<std::optional<SurfaceTexture>> made(surfaces_.size());
  const bool whole = runJobs(
      made.size(), threads, [&](std::size_t i) { made[i].emplace(surfaces_[i], density); }, report);
  check(whole, ErrorCode::cancelled, "stopped");
  for (auto& texture : made) textures_.push_back(std::move(*texture));
}

SurfaceRenderer::Visible SurfaceRenderer::visible(const Camera& camera, glm::dvec2 offset) const {
  const Intrinsics& k = camera.intrinsics;
  const glm::dmat3 axes = glm::mat3_cast(camera.pose.rotation);
  // Columns: derivatives of a pixel's ray by x and y, and the ray of the first sample.
  const glm::dmat3 rays(axes[0] / k.fx, -axes[1] / k.fy,
                        axes * glm::dvec3((offset.x - k.cx) / k.fx, (k.cy - offset.y) / k.fy, -1));
  Visible shown{{}, Image<std::uint16_t>(k.width, k.height, 1), ImageF(k.width, k.height, 1)};
  for (std::size_t i = 0; i < surfaces_.size(); ++i) {
    const Surface& s = surfaces_[i];
    const glm::dvec3 normal = glm::cross(s.u, s.v), to = s.origin - camera.pose.position;
    const double away = glm::dot(normal, to);
    const double radius = 0.5 * std::hypot(s.extentU, s.extentV);
    if (away == 0 || glm::dot(to, -axes[2]) < -radius) continue;
    const auto linear = [&](glm::dvec3 axis) { return axis * rays; };
    const Linear w = linear(normal) / away, u = linear(s.u) - glm::dot(to, s.u) * w,
                 v = linear(s.v) - glm::dot(to, s.v) * w;
    const double area = std::abs(glm::determinant(glm::dmat3(w, u, v))) * density_ * density_;
    const std::array inside{0.5 * s.extentU * w - u, 0.5 * s.extentU * w + u,         0.5 * s.extentV * w - v,
                            0.5 * s.extentV * w + v, w - Linear(0, 0, 1 / kFarthest), Linear(0, 0, 1 / kNearest) - w};
    shown.projected.push_back({std::uint16_t(i), w, u, v, float(area)});
    const auto index = std::uint16_t(shown.projected.size());
    for (int y = 0; y < k.height; ++y) {
      double first = 0, last = k.width;
      for (const Linear& f : inside) narrow(f.x, f.y * y + f.z, first, last);
      if (!(first < last)) continue;
      const int end = std::min(k.width, int(std::ceil(last)));
      float* nearest = shown.inverseDepth.pixel(0, y).data();
      std::uint16_t* row = shown.index.pixel(0, y).data();
      const float slope = float(w.x), start = at(w, 0, y);
      for (int x = int(std::ceil(first)); x < end; ++x)
        if (const float here = start + slope * float(x); here > nearest[x]) {
          nearest[x] = here;
          row[x] = index;
        }
    }
  }
  return shown;
}

void SurfaceRenderer::addSamples(const Camera& camera, glm::dvec2 offset, ImageF& sum) const {
  const Visible shown = visible(camera, offset);
  for (int y = 0; y < sum.height; ++y)
    for (int x = 0; x < sum.width; ++x) {
      const std::uint16_t index = shown.index.pixel(x, y)[0];
      if (index == 0) continue;
      const Projected& p = shown.projected[index - 1u];
      const Surface& s = surfaces_[p.surface];
      const float depth = 1 / shown.inverseDepth.pixel(x, y)[0];
      const glm::vec2 share(0.5f + at(p.u, x, y) * depth / float(s.extentU),
                            0.5f + at(p.v, x, y) * depth / float(s.extentV));
      const float level = 0.5f * std::log2(p.texelsPerPixel * depth * depth * depth) + kLevelBias;
      const glm::vec3 colour = textures_[p.surface].sample(share, level);
      float* into = sum.pixel(x, y).data();
      for (int c = 0; c < 3; ++c) into[c] += colour[c];
    }
}

ImageF SurfaceRenderer::inverseDepth(const Camera& camera) const {
  return visible(camera, {0.5, 0.5}).inverseDepth;
}

glm::dvec2 sampleOffset(std::size_t i) {
  // The two-dimensional golden ratio's sequence (M. Roberts, 2018).
  constexpr double kGolden = 1.32471795724474602596;
  const double x = 0.5 + double(i + 1) / kGolden, y = 0.5 + double(i + 1) / (kGolden * kGolden);
  return {x - std::floor(x), y - std::floor(y)};
}

Image8 encodedMean(const ImageF& sum, std::size_t samples) {
  static const std::vector<std::uint8_t> table = [] {
    std::vector<std::uint8_t> made(65536);
    for (std::size_t i = 0; i < made.size(); ++i)
      made[i] = std::uint8_t(std::lround(255 * linearToSrgb(double(i) / 65535)));
    return made;
  }();
  Image8 image(sum.width, sum.height, 3);
  for (int y = 0; y < sum.height; ++y)
    for (int x = 0; x < sum.width; ++x)
      for (std::size_t c = 0; c < 3; ++c) {
        const float mean = std::clamp(sum.pixel(x, y)[c] / float(samples), 0.0f, 1.0f);
        image.pixel(x, y)[c] = table[std::size_t(mean * 65535 + 0.5f)];
      }
  return image;
}

}  // namespace ibr
