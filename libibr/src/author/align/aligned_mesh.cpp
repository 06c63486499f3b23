// SPDX-License-Identifier: Apache-2.0
#include "author/align/aligned_mesh.h"

#include <algorithm>
#include <utility>

#include "author/geometry/mesh_signs.h"
#include "author/mesh/uncertainty.h"
#include "base/median.h"

namespace ibr::aligning {
namespace {

// Planes that contain all three points.
glm::u16vec4 sharedPlanes(const std::vector<glm::u16vec4>& planes, const glm::uvec3& points) {
  glm::u16vec4 shared(0);
  int count = 0;
  const auto has = [&](unsigned point, std::uint16_t plane) {
    const glm::u16vec4& set = planes[point];
    return set.x == plane || set.y == plane || set.z == plane || set.w == plane;
  };
  for (int k = 0; k < 4; ++k) {
    const std::uint16_t plane = planes[points.x][k];
    if (plane != 0 && has(points.y, plane) && has(points.z, plane)) shared[count++] = plane;
  }
  return shared;
}

}  // namespace

bool isUpright(const MorphMesh& mesh, const glm::uvec3& t) {
  return (meshSigns(mesh.match, t) & 1u) != 0;
}

std::size_t revertFolded(const MorphMesh& mesh, Match& moved, const Signs& signs) {
  std::vector<bool> back(mesh.vertexCount(), false);
  for (bool again = true; again;) {
    again = false;
    for (const glm::uvec3& t : mesh.triangles) {
      const auto folds = [&](const glm::uvec3& way) { return (signs(mesh.match, way) & ~signs(moved, way)) != 0; };
      if (!folds(t) && !folds(turned(t))) continue;
      for (int k = 0; k < 3; ++k) {
        const unsigned p = t[k];
        for (std::size_t i = 0; i < moved.size(); ++i) {
          if (moved[i][p] == mesh.match[i][p]) continue;
          moved[i][p] = mesh.match[i][p];
          back[p] = again = true;
        }
      }
    }
  }
  return std::size_t(std::ranges::count(back, true));
}

std::size_t revertFolded(const MorphMesh& before, MorphMesh& now) {
  const std::vector<std::size_t> changed = changedTriangles(before, now);
  MorphMesh others = before;
  for (const std::size_t t : changed)
    if (t < others.triangles.size()) others.triangles[t] = glm::uvec3(0);  // never positive: blocks no move
  Match match = now.match;
  std::size_t back = revertFolded(others, match, meshSigns);
  const bool stand = std::ranges::all_of(changed, [&](std::size_t t) {
    const glm::uvec3 was = before.triangles[t < before.triangles.size() ? t : changed[0]], is = now.triangles[t];
    return meshSigns(match, isUpright(before, was) ? is : turned(is)) == allPositive(match.size());
  });
  if (!stand) {
    now.triangles = before.triangles;
    match = now.match;
    for (auto& at : match) at.resize(before.vertexCount());
    back = revertFolded(before, match, meshSigns);
  }
  now.match = std::move(match);
  return back;
}

std::vector<bool> movedPoints(const Match& before, const Match& after) {
  std::vector<bool> moved(before[0].size(), false);
  for (std::size_t i = 0; i < before.size(); ++i)
    for (std::size_t p = 0; p < before[i].size(); ++p)
      if (before[i][p] != after[i][p]) moved[p] = true;
  moved.resize(after[0].size(), true);
  return moved;
}

std::vector<std::size_t> movedTriangles(const MorphMesh& mesh, const std::vector<bool>& moved) {
  std::vector<std::size_t> triangles;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::uvec3& corner = mesh.triangles[t];
    if (moved[corner.x] || moved[corner.y] || moved[corner.z]) triangles.push_back(t);
  }
  return triangles;
}

std::vector<std::size_t> changedTriangles(const MorphMesh& before, const MorphMesh& now) {
  std::vector<std::size_t> changed;
  for (std::size_t t = 0; t < now.triangles.size(); ++t)
    if (t >= before.triangles.size() || now.triangles[t] != before.triangles[t]) changed.push_back(t);
  return changed;
}

void extendLists(MorphMesh& mesh, std::span<const InsertedPoint> inserted) {
  mesh.tier.resize(mesh.triangles.size(), kTierConsistent);
  mesh.ecc.resize(mesh.triangles.size(), 0.0f);
  for (const InsertedPoint& point : inserted) {
    mesh.inverseDistance.push_back(0.0f);
    mesh.uncertainty.push_back(0.0f);
    for (auto& ratio : mesh.ratio) ratio.push_back(1.0f);
    if (!mesh.planes.empty()) mesh.planes.push_back(sharedPlanes(mesh.planes, point.parent));
  }
}

void sortByTier(MorphMesh& mesh) {
  const auto first = std::ranges::find_if(mesh.tier, [](std::uint8_t tier) { return tier != kTierConsistent; });
  const auto last = std::find(first, mesh.tier.end(), std::uint8_t(kTierConsistent));
  const auto rotate = [&](auto& list) {
    std::rotate(list.begin() + (first - mesh.tier.begin()), list.begin() + (last - mesh.tier.begin()), list.end());
  };
  rotate(mesh.triangles);
  rotate(mesh.ecc);
  std::rotate(first, last, mesh.tier.end());
}

void updateRanges(MorphMesh& mesh, const std::vector<bool>& moved, std::span<const RangeFit> range,
                  std::span<const double> level) {
  for (std::size_t p = 0; p < moved.size(); ++p) {
    if (!moved[p]) continue;
    mesh.inverseDistance[p] = float(range[p].inverseDistance);
    for (std::size_t i = 0; i < mesh.ratio.size(); ++i) mesh.ratio[i][p] = float(range[p].ratio[i]);
  }
  MorphMesh fresh = mesh;
  for (std::size_t p = 0; p < moved.size(); ++p) fresh.uncertainty[p] = float(range[p].uncertainty);
  if (!level.empty()) widenUncertainty(fresh, level);
  for (std::size_t p = 0; p < moved.size(); ++p)
    if (moved[p]) mesh.uncertainty[p] = fresh.uncertainty[p];
}

CellQuality qualityOf(const MorphMesh& mesh, CellQuality quality, std::vector<double> residuals,
                      const std::function<double(const glm::uvec3&)>& area) {
  double covered = 0, weighted = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.tier[t] != kTierConsistent) continue;
    const double size = area(mesh.triangles[t]);
    covered += size;
    weighted += size * double(mesh.ecc[t]);
  }
  const double before = quality.ecc;
  if (covered > 0) quality.ecc = std::clamp(weighted / covered, -1.0, 1.0);
  if (before > 0) quality.score = std::min(quality.score * std::max(quality.ecc, 0.0) / before, 1.0);
  if (!residuals.empty()) quality.residualPx = median(std::move(residuals));
  return quality;
}

}  // namespace ibr::aligning
