// SPDX-License-Identifier: Apache-2.0
// Compares a cell's triangles with the true positions, in the other members, of the surface that the first member sees.
#include "ibr/lab/accuracy.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "author/eval/exact_surface.h"

namespace ibr {
namespace {

constexpr double kCorrectPx = 1.5;
constexpr double kMinCorrectShare = 0.8;

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

// Index of the triangle at each pixel of the first member: of the lowest tier, and of these the nearest.
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
  CellAccuracy(const Cell& cell, const std::vector<const ExactSurface*>& surfaces)
      : mesh_(cell.mesh), surfaces_(surfaces) {}

  MatchAccuracy run() {
    pixels();
    vertices();
    for (std::size_t t = 0, count = mesh_.tier0Count(); t < count; ++t) {
      const bool first = area(mesh_.match[0], mesh_.triangles[t]) > 0;
      result_.folded += std::ranges::any_of(mesh_.match, [&](const std::vector<glm::vec2>& at) {
        const double size = area(at, mesh_.triangles[t]);
        return size == 0 || (size > 0) != first;
      });
    }
    return std::move(result_);
  }

 private:
  // Px: distance between a surface point's true position and its position by `t`, in the worst member.
  double error(const glm::uvec3& t, const ExactSurface::Sample& sample) const {
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
    const ExactSurface& first = *surfaces_[0];
    const std::vector<std::uint32_t> map = triangleMap(mesh_, first.width(), first.height());
    struct Count {
      double known = 0, correct = 0;
    };
    std::vector<Count> counts(mesh_.triangles.size());
    for (int y = 0; y < first.height(); ++y)
      for (int x = 0; x < first.width(); ++x) {
        const auto sample = first.at({x, y});
        if (!sample) continue;
        const bool coVisible = std::all_of(surfaces_.begin() + 1, surfaces_.end(),
                                           [&](const ExactSurface* s) { return s->sees(sample->point); });
        const std::uint32_t t = map[std::size_t(y) * std::size_t(first.width()) + std::size_t(x)];
        result_.coVisible += coVisible;
        if (t == kNone) continue;
        result_.coVisibleTier0 += coVisible && mesh_.tier[t] == kTierConsistent;
        ++counts[t].known;
        counts[t].correct += coVisible && error(mesh_.triangles[t], *sample) <= kCorrectPx;
      }
    for (std::size_t t = 0; t < counts.size(); ++t) {
      const bool agrees = mesh_.tier[t] == kTierConsistent,
                 correct = counts[t].correct >= kMinCorrectShare * counts[t].known;
      if (agrees) result_.tier0 += counts[t].known;
      if (agrees && correct) result_.correctTier0 += counts[t].known;
      if (correct) result_.correct += counts[t].known;
    }
  }

  void vertices() {
    std::vector<bool> used(mesh_.vertexCount(), false);
    for (std::size_t t = 0, count = mesh_.tier0Count(); t < count; ++t)
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
      result_.vertexErrorsPx.push_back(worst);
      const double rho = point->w * double(surfaces_.size()) / distance;
      result_.deviation.push_back(std::abs(double(mesh_.inverseDistance[v]) - rho) /
                                  std::max(double(mesh_.uncertainty[v]), 1e-12));
    }
  }

  const MorphMesh& mesh_;
  const std::vector<const ExactSurface*>& surfaces_;
  MatchAccuracy result_;
};

}  // namespace

MatchAccuracy& MatchAccuracy::operator+=(const MatchAccuracy& other) {
  vertexErrorsPx.insert(vertexErrorsPx.end(), other.vertexErrorsPx.begin(), other.vertexErrorsPx.end());
  deviation.insert(deviation.end(), other.deviation.begin(), other.deviation.end());
  coVisible += other.coVisible;
  coVisibleTier0 += other.coVisibleTier0;
  tier0 += other.tier0;
  correctTier0 += other.correctTier0;
  correct += other.correct;
  folded += other.folded;
  return *this;
}

std::vector<MatchAccuracy> matchAccuracy(const Scene& scene, std::span<const ExactDepthView> truth, int threads,
                                         const ProgressCallback& progress) {
  const auto surfaces = exactSurfaces(scene, truth, threads, progress);
  std::vector<MatchAccuracy> result(scene.cells.size());
  forEachCell(scene, "comparing matches", threads, progress, [&](std::size_t c) {
    const auto members = surfacesOf(scene, scene.cells[c], surfaces);
    if (!members.empty()) result[c] = CellAccuracy(scene.cells[c], members).run();
  });
  return result;
}

}  // namespace ibr
