// SPDX-License-Identifier: Apache-2.0
// Every depth view's surface is brought into every photograph, nearest first; there a cell's triangles are compared
// with where the surface is seen by the other members.
#include "ibr/accuracy.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec4.hpp>
#include <limits>
#include <optional>
#include <set>
#include <thread>

#include "author/parallel.h"
#include "base/check.h"

namespace ibr {
namespace {

constexpr double kRightPx = 1.5;
constexpr double kRightShare = 0.8;
constexpr double kSameSurface = 0.02;  // of inverse depth; or …
constexpr double kSameParallax = 1.5;  // … px, seen from a unit of length aside

// A point, or with w = 0 a direction.
using Homogeneous = glm::dvec4;

struct Projected {
  glm::dvec2 pixel;
  double inverseDepth;  // along the axis
};

std::optional<Projected> projected(const Camera& camera, const glm::dmat3& toCamera, const Homogeneous& point) {
  const glm::dvec3 d = toCamera * (glm::dvec3(point) - point.w * camera.pose.position);
  const Intrinsics& k = camera.intrinsics;
  if (!(d.z < 0)) return std::nullopt;
  return Projected{{k.cx - k.fx * d.x / d.z, k.cy + k.fy * d.y / d.z}, -point.w / d.z};
}

// What a photograph should see, a surface point a pixel.
class Surface {
 public:
  Surface(const Camera& camera, std::span<const DepthView> truth)
      : camera_(camera),
        toCamera_(glm::mat3_cast(glm::conjugate(camera.pose.rotation))),
        width_(camera.intrinsics.width),
        height_(camera.intrinsics.height),
        pixels_(std::size_t(width_) * std::size_t(height_)) {
    for (const DepthView& view : truth) add(view);
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x)
        if (Pixel& p = pixels_[at(x, y)]; p.known()) p.front = !hidden(x, y, double(p.inverseDepth));
  }

  const Camera& camera() const { return camera_; }
  int width() const { return width_; }
  int height() const { return height_; }

  struct Sample {
    glm::dvec2 pixel;
    Homogeneous point;
  };
  /// nullopt where it is not known, or something may stand before it.
  std::optional<Sample> at(glm::ivec2 pixel) const {
    const Pixel& p = pixels_[at(pixel.x, pixel.y)];
    if (!p.known() || !p.front) return std::nullopt;
    return Sample{p.where, point(p.where, double(p.inverseDepth))};
  }

  std::optional<glm::dvec2> seen(const Homogeneous& point) const {
    const auto p = projected(camera_, toCamera_, point);
    return p ? std::optional(p->pixel) : std::nullopt;
  }
  bool sees(const Homogeneous& point) const {
    const auto p = projected(camera_, toCamera_, point);
    if (!p || !inside(p->pixel)) return false;
    return !hidden(int(p->pixel.x), int(p->pixel.y), p->inverseDepth);
  }

  /// The surface at a pixel's fraction: a plane through what is known around it.
  std::optional<Homogeneous> between(glm::dvec2 pixel) const {
    if (!inside(pixel) || !at(glm::ivec2(pixel))) return std::nullopt;
    const double here = double(pixels_[at(int(pixel.x), int(pixel.y))].inverseDepth);
    glm::dmat3 normal(0.0);
    glm::dvec3 side(0.0);
    forAround(int(pixel.x), int(pixel.y), [&](const Pixel& p) {
      const double off = double(p.inverseDepth) - here;
      if (!p.known() || std::abs(off) > tolerance(here)) return;
      const glm::dvec3 row(1.0, glm::dvec2(p.where) - pixel);
      normal += glm::outerProduct(row, row);
      side += row * off;
    });
    constexpr double kRidge = 1e-6;  // fewer than three pixels: no slope
    normal[1][1] += kRidge;
    normal[2][2] += kRidge;
    return point(pixel, std::max(here + (glm::inverse(normal) * side).x, 0.0));
  }

 private:
  struct Pixel {
    glm::vec2 where{0.0f};
    float inverseDepth = -1;
    bool front = false;
    bool known() const { return inverseDepth >= 0; }
  };

  std::size_t at(int x, int y) const { return std::size_t(y) * std::size_t(width_) + std::size_t(x); }
  bool inside(glm::dvec2 p) const { return p.x >= 0 && p.y >= 0 && p.x < width_ && p.y < height_; }
  double tolerance(double inverseDepth) const {
    return std::max(kSameSurface * inverseDepth, kSameParallax / camera_.intrinsics.fx);
  }
  Homogeneous point(glm::dvec2 pixel, double inverseDepth) const {
    const Intrinsics& k = camera_.intrinsics;
    const glm::dvec3 ray = camera_.pose.rotation * glm::dvec3((pixel.x - k.cx) / k.fx, (k.cy - pixel.y) / k.fy, -1.0);
    return Homogeneous(ray + inverseDepth * camera_.pose.position, inverseDepth);
  }
  template <class Visit>
  void forAround(int x, int y, Visit&& visit) const {
    for (int v = std::max(y - 1, 0); v <= std::min(y + 1, height_ - 1); ++v)
      for (int u = std::max(x - 1, 0); u <= std::min(x + 1, width_ - 1); ++u) visit(pixels_[at(u, v)]);
  }
  // By the nearest surface around: views may have missed it in the pixel itself.
  bool hidden(int x, int y, double inverseDepth) const {
    double nearest = 0;
    forAround(x, y, [&](const Pixel& p) { nearest = std::max(nearest, double(p.inverseDepth)); });
    return nearest > inverseDepth + tolerance(inverseDepth);
  }

  void add(const DepthView& view) {
    const Intrinsics& k = view.camera.intrinsics;
    const glm::dmat3 toWorld = glm::mat3_cast(view.camera.pose.rotation);
    for (int y = 0; y < k.height; ++y)
      for (int x = 0; x < k.width; ++x) {
        const double depth = double(view.depth.pixel(x, y)[0]);
        const glm::dvec3 ray = toWorld * glm::dvec3((x + 0.5 - k.cx) / k.fx, (k.cy - y - 0.5) / k.fy, -1.0);
        const Homogeneous point =
            depth > 0 ? Homogeneous(view.camera.pose.position + depth * ray, 1.0) : Homogeneous(ray, 0.0);
        const auto p = projected(camera_, toCamera_, point);
        if (!p || !inside(p->pixel)) continue;
        Pixel& pixel = pixels_[at(int(p->pixel.x), int(p->pixel.y))];
        if (double(pixel.inverseDepth) < p->inverseDepth) pixel = {p->pixel, float(p->inverseDepth), false};
      }
  }

  Camera camera_;
  glm::dmat3 toCamera_;
  int width_, height_;
  std::vector<Pixel> pixels_;
};

double area(const std::vector<glm::vec2>& at, const glm::uvec3& t) {
  const glm::dvec2 a = glm::dvec2(at[t.y]) - glm::dvec2(at[t.x]), b = glm::dvec2(at[t.z]) - glm::dvec2(at[t.x]);
  return a.x * b.y - a.y * b.x;
}

glm::dvec3 barycentric(const std::vector<glm::vec2>& at, const glm::uvec3& t, glm::dvec2 p) {
  const glm::dvec2 a(at[t.x]), b = glm::dvec2(at[t.y]) - a, c = glm::dvec2(at[t.z]) - a, q = p - a;
  const double whole = b.x * c.y - b.y * c.x;
  const double y = (q.x * c.y - q.y * c.x) / whole, z = (b.x * q.y - b.y * q.x) / whole;
  return {1 - y - z, y, z};
}

// The triangle that each pixel of the first member lies in: of the lowest tier, and there the nearest.
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
std::vector<std::uint32_t> triangleMap(const MorphMesh& mesh, int width, int height) {
  std::vector<std::uint32_t> map(std::size_t(width) * std::size_t(height), kNone);
  ImageF nearest(width, height, 1);
  const std::vector<glm::vec2>& at = mesh.match[0];
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::uvec3& corner = mesh.triangles[t];
    if (area(at, corner) == 0) continue;
    const glm::dvec2 low = glm::min(glm::min(at[corner.x], at[corner.y]), at[corner.z]);
    const glm::dvec2 high = glm::max(glm::max(at[corner.x], at[corner.y]), at[corner.z]);
    const glm::dvec3 rho(mesh.inverseDistance[corner.x], mesh.inverseDistance[corner.y],
                         mesh.inverseDistance[corner.z]);
    for (int y = std::max(int(low.y), 0); y <= std::min(int(high.y), height - 1); ++y)
      for (int x = std::max(int(low.x), 0); x <= std::min(int(high.x), width - 1); ++x) {
        const glm::dvec3 w = barycentric(at, corner, {x + 0.5, y + 0.5});
        if (std::min({w.x, w.y, w.z}) < 0) continue;
        std::uint32_t& there = map[std::size_t(y) * std::size_t(width) + std::size_t(x)];
        float& front = nearest.pixel(x, y)[0];
        const auto distance = float(glm::dot(w, rho));
        if (there != kNone &&
            (mesh.tier[there] < mesh.tier[t] || (mesh.tier[there] == mesh.tier[t] && front > distance)))
          continue;
        there = t;
        front = distance;
      }
  }
  return map;
}

class CellAccuracy {
 public:
  CellAccuracy(const Cell& cell, const std::vector<const Surface*>& surfaces) : mesh_(cell.mesh), surfaces_(surfaces) {}

  MatchAccuracy run() {
    pixels();
    vertices();
    for (std::size_t t = 0; t < mesh_.tier0Count(); ++t) {
      const bool first = area(mesh_.match[0], mesh_.triangles[t]) > 0;
      result_.folded += std::ranges::any_of(mesh_.match, [&](const std::vector<glm::vec2>& at) {
        const double size = area(at, mesh_.triangles[t]);
        return size == 0 || (size > 0) != first;
      });
    }
    return std::move(result_);
  }

 private:
  // px, the worst member's distance between where a surface is seen and where `t` puts it.
  double error(const glm::uvec3& t, const Surface::Sample& sample) const {
    const glm::dvec3 w = barycentric(mesh_.match[0], t, sample.pixel);
    double worst = 0;
    for (std::size_t i = 1; i < mesh_.match.size(); ++i) {
      const std::vector<glm::vec2>& at = mesh_.match[i];
      const glm::dvec2 put = w.x * glm::dvec2(at[t.x]) + w.y * glm::dvec2(at[t.y]) + w.z * glm::dvec2(at[t.z]);
      const auto seen = surfaces_[i]->seen(sample.point);
      worst = std::max(worst, seen ? glm::distance(put, *seen) : std::numeric_limits<double>::infinity());
    }
    return worst;
  }

  void pixels() {
    const Surface& first = *surfaces_[0];
    const std::vector<std::uint32_t> map = triangleMap(mesh_, first.width(), first.height());
    struct Count {
      double known = 0, right = 0;
    };
    std::vector<Count> counts(mesh_.triangles.size());
    for (int y = 0; y < first.height(); ++y)
      for (int x = 0; x < first.width(); ++x) {
        const auto sample = first.at({x, y});
        if (!sample) continue;
        const bool coVisible = std::all_of(surfaces_.begin() + 1, surfaces_.end(),
                                           [&](const Surface* s) { return s->sees(sample->point); });
        const std::uint32_t t = map[std::size_t(y) * std::size_t(first.width()) + std::size_t(x)];
        result_.coVisible += coVisible;
        if (t == kNone) continue;
        result_.kept += coVisible && mesh_.tier[t] == kTierAgrees;
        ++counts[t].known;
        counts[t].right += coVisible && error(mesh_.triangles[t], *sample) <= kRightPx;
      }
    for (std::size_t t = 0; t < counts.size(); ++t) {
      const bool agrees = mesh_.tier[t] == kTierAgrees, right = counts[t].right >= kRightShare * counts[t].known;
      if (agrees) result_.tier0 += counts[t].known;
      if (agrees && right) result_.rightTier0 += counts[t].known;
      if (right) result_.right += counts[t].known;
    }
  }

  void vertices() {
    std::vector<bool> used(mesh_.pointCount(), false);
    for (std::size_t t = 0; t < mesh_.tier0Count(); ++t)
      for (int k = 0; k < 3; ++k) used[mesh_.triangles[t][k]] = true;
    for (std::size_t v = 0; v < used.size(); ++v) {
      if (!used[v]) continue;
      const auto point = surfaces_[0]->between(mesh_.match[0][v]);
      if (!point) continue;
      double worst = 0, distance = 0;
      for (std::size_t i = 0; i < surfaces_.size(); ++i) {
        const auto seen = surfaces_[i]->seen(*point);
        worst = std::max(worst, seen ? glm::distance(glm::dvec2(mesh_.match[i][v]), *seen)
                                     : std::numeric_limits<double>::infinity());
        distance += glm::length(glm::dvec3(*point) - point->w * surfaces_[i]->camera().pose.position);
      }
      result_.vertexError.push_back(worst);
      const double rho = point->w * double(surfaces_.size()) / distance;
      result_.deviation.push_back(std::abs(double(mesh_.inverseDistance[v]) - rho) /
                                  std::max(double(mesh_.uncertainty[v]), 1e-12));
    }
  }

  const MorphMesh& mesh_;
  const std::vector<const Surface*>& surfaces_;
  MatchAccuracy result_;
};

}  // namespace

MatchAccuracy& MatchAccuracy::operator+=(const MatchAccuracy& other) {
  vertexError.insert(vertexError.end(), other.vertexError.begin(), other.vertexError.end());
  deviation.insert(deviation.end(), other.deviation.begin(), other.deviation.end());
  coVisible += other.coVisible;
  kept += other.kept;
  tier0 += other.tier0;
  rightTier0 += other.rightTier0;
  right += other.right;
  folded += other.folded;
  return *this;
}

std::vector<MatchAccuracy> matchAccuracy(const Scene& scene, std::span<const DepthView> truth, int threads,
                                         const ProgressCallback& progress) {
  for (const DepthView& view : truth) {
    const Intrinsics& k = view.camera.intrinsics;
    check(k.model == CameraModel::pinhole, ErrorCode::invalidInput, "a view with exact depth is not a pinhole");
    check(view.depth.width == k.width && view.depth.height == k.height && view.depth.channels == 1,
          ErrorCode::invalidInput, "a view of {}×{} px has exact depth of {}×{}", k.width, k.height, view.depth.width,
          view.depth.height);
  }
  const auto pinhole = [&](std::uint32_t n) { return scene.nodes[n].camera.intrinsics.model == CameraModel::pinhole; };
  std::set<std::uint32_t> needed;
  for (const Cell& cell : scene.cells)
    if (std::ranges::all_of(cell.members, pinhole)) needed.insert(cell.members.begin(), cell.members.end());
  const std::vector<std::uint32_t> nodes(needed.begin(), needed.end());
  const int workers = threads > 0 ? threads : std::max(1, int(std::thread::hardware_concurrency()));
  const auto runAll = [&](std::string_view stage, std::size_t count, const std::function<void(std::size_t)>& job) {
    check(runJobs(count, workers, job,
                  [&](std::size_t done) {
                    return !progress || progress({stage, done, count});
                  }),
          ErrorCode::cancelled, "cancelled while {}", stage);
  };

  std::vector<std::optional<Surface>> surfaces(scene.nodes.size());
  runAll("placing the exact surface", nodes.size(),
         [&](std::size_t n) { surfaces[nodes[n]].emplace(scene.nodes[nodes[n]].camera, truth); });
  std::vector<MatchAccuracy> result(scene.cells.size());
  runAll("comparing matches", scene.cells.size(), [&](std::size_t c) {
    const Cell& cell = scene.cells[c];
    if (!std::ranges::all_of(cell.members, pinhole)) return;
    std::vector<const Surface*> members;
    for (const std::uint32_t n : cell.members) members.push_back(&*surfaces[n]);
    result[c] = CellAccuracy(cell, members).run();
  });
  return result;
}

}  // namespace ibr
