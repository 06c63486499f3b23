// SPDX-License-Identifier: Apache-2.0
#include "author/eval/exact_surface.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>
#include <set>

#include "base/check.h"
#include "base/parallel.h"

namespace ibr {
namespace {

constexpr double kSameSurface = 0.02;  // relative to inverse depth; or …
constexpr double kSameParallax = 1.5;  // … px, seen from one world unit aside

}  // namespace

ExactSurface::ExactSurface(const Camera& camera, std::span<const ExactDepthView> truth)
    : camera_(camera),
      toCamera_(glm::mat3_cast(glm::conjugate(camera.pose.rotation))),
      width_(camera.intrinsics.width),
      height_(camera.intrinsics.height),
      pixels_(std::size_t(width_) * std::size_t(height_)) {
  for (const ExactDepthView& view : truth) add(view);
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x)
      if (Pixel& p = pixels_[index(x, y)]; p.known()) p.front = !hidden(x, y, double(p.inverseDepth));
}

std::optional<ExactSurface::Projected> ExactSurface::projected(const Homogeneous& point) const {
  const glm::dvec3 d = toCamera_ * (glm::dvec3(point) - point.w * camera_.pose.position);
  const Intrinsics& k = camera_.intrinsics;
  if (!(d.z < 0)) return std::nullopt;
  return Projected{{k.cx - k.fx * d.x / d.z, k.cy + k.fy * d.y / d.z}, -point.w / d.z};
}

std::optional<ExactSurface::Sample> ExactSurface::at(glm::ivec2 pixel) const {
  const Pixel& p = pixels_[index(pixel.x, pixel.y)];
  if (!p.known() || !p.front) return std::nullopt;
  return Sample{p.where, point(p.where, double(p.inverseDepth))};
}

std::optional<glm::dvec2> ExactSurface::seen(const Homogeneous& point) const {
  const auto p = projected(point);
  return p ? std::optional(p->pixel) : std::nullopt;
}

bool ExactSurface::sees(const Homogeneous& point) const {
  const auto p = projected(point);
  return p && inside(p->pixel) && !hidden(int(p->pixel.x), int(p->pixel.y), p->inverseDepth);
}

double ExactSurface::tolerance(double inverseDepth) const {
  return std::max(kSameSurface * inverseDepth, kSameParallax / camera_.intrinsics.fx);
}

Homogeneous ExactSurface::point(glm::dvec2 pixel, double inverseDepth) const {
  const Intrinsics& k = camera_.intrinsics;
  const glm::dvec3 ray = camera_.pose.rotation * glm::dvec3((pixel.x - k.cx) / k.fx, (k.cy - pixel.y) / k.fy, -1.0);
  return Homogeneous(ray + inverseDepth * camera_.pose.position, inverseDepth);
}

template <class Visit>
void ExactSurface::forNeighbours(int x, int y, Visit&& visit) const {
  for (int v = std::max(y - 1, 0); v <= std::min(y + 1, height_ - 1); ++v)
    for (int u = std::max(x - 1, 0); u <= std::min(x + 1, width_ - 1); ++u) visit(pixels_[index(u, v)]);
}

// Compares with the nearest surface of 3×3 pixels: depth views may have missed the pixel itself.
bool ExactSurface::hidden(int x, int y, double inverseDepth) const {
  double nearest = 0;
  forNeighbours(x, y, [&](const Pixel& p) { nearest = std::max(nearest, double(p.inverseDepth)); });
  return nearest > inverseDepth + tolerance(inverseDepth);
}

std::optional<Homogeneous> ExactSurface::between(glm::dvec2 pixel) const {
  if (!inside(pixel) || !at(glm::ivec2(pixel))) return std::nullopt;
  const double here = double(pixels_[index(int(pixel.x), int(pixel.y))].inverseDepth);
  glm::dmat3 normal(0.0);
  glm::dvec3 side(0.0);
  forNeighbours(int(pixel.x), int(pixel.y), [&](const Pixel& p) {
    const double off = double(p.inverseDepth) - here;
    if (!p.known() || std::abs(off) > tolerance(here)) return;
    const glm::dvec3 row(1.0, glm::dvec2(p.where) - pixel);
    normal += glm::outerProduct(row, row);
    side += row * off;
  });
  constexpr double kRidge = 1e-6;  // regularises the slope where fewer than three pixels are known
  normal[1][1] += kRidge;
  normal[2][2] += kRidge;
  return point(pixel, std::max(here + (glm::inverse(normal) * side).x, 0.0));
}

void ExactSurface::add(const ExactDepthView& view) {
  const Intrinsics& k = view.camera.intrinsics;
  const glm::dmat3 toWorld = glm::mat3_cast(view.camera.pose.rotation);
  for (int y = 0; y < k.height; ++y)
    for (int x = 0; x < k.width; ++x) {
      const double depth = double(view.depth.pixel(x, y)[0]);
      const glm::dvec3 ray = toWorld * glm::dvec3((x + 0.5 - k.cx) / k.fx, (k.cy - y - 0.5) / k.fy, -1.0);
      const Homogeneous point =
          depth > 0 ? Homogeneous(view.camera.pose.position + depth * ray, 1.0) : Homogeneous(ray, 0.0);
      const auto p = projected(point);
      if (!p || !inside(p->pixel)) continue;
      Pixel& pixel = pixels_[index(int(p->pixel.x), int(p->pixel.y))];
      if (double(pixel.inverseDepth) < p->inverseDepth) pixel = {p->pixel, float(p->inverseDepth), false};
    }
}

namespace {

bool isOfPinholes(const Scene& scene, const Cell& cell) {
  return std::ranges::all_of(
      cell.members, [&](std::uint32_t n) { return scene.nodes[n].camera.intrinsics.model == CameraModel::pinhole; });
}

void forEachOf(std::string_view stage, std::size_t count, int threads, const ProgressCallback& progress,
               const std::function<void(std::size_t)>& job) {
  const bool finished = runJobs(count, threadsFor(threads, 0), job, [&](std::size_t done) {
    return !progress || progress({stage, done, count});
  });
  check(finished, ErrorCode::cancelled, "cancelled while {}", stage);
}

}  // namespace

std::vector<std::optional<ExactSurface>> exactSurfaces(const Scene& scene, std::span<const ExactDepthView> truth,
                                                       int threads, const ProgressCallback& progress) {
  for (const ExactDepthView& view : truth) {
    const Intrinsics& k = view.camera.intrinsics;
    check(k.model == CameraModel::pinhole, ErrorCode::invalidInput, "a view with exact depth is not a pinhole");
    check(view.depth.width == k.width && view.depth.height == k.height && view.depth.channels == 1,
          ErrorCode::invalidInput, "a view has {}×{} px, its exact depth {}×{} px", k.width, k.height, view.depth.width,
          view.depth.height);
  }
  std::set<std::uint32_t> needed;
  for (const Cell& cell : scene.cells)
    if (isOfPinholes(scene, cell)) needed.insert(cell.members.begin(), cell.members.end());
  const std::vector<std::uint32_t> nodes(needed.begin(), needed.end());
  std::vector<std::optional<ExactSurface>> surfaces(scene.nodes.size());
  forEachOf("computing exact surfaces", nodes.size(), threads, progress,
            [&](std::size_t n) { surfaces[nodes[n]].emplace(scene.nodes[nodes[n]].camera, truth); });
  return surfaces;
}

std::vector<const ExactSurface*> surfacesOf(const Scene& scene, const Cell& cell,
                                            const std::vector<std::optional<ExactSurface>>& surfaces) {
  std::vector<const ExactSurface*> members;
  if (isOfPinholes(scene, cell))
    for (const std::uint32_t n : cell.members) members.push_back(&*surfaces[n]);
  return members;
}

void forEachCell(const Scene& scene, std::string_view stage, int threads, const ProgressCallback& progress,
                 const std::function<void(std::size_t)>& job) {
  forEachOf(stage, scene.cells.size(), threads, progress, job);
}

}  // namespace ibr
