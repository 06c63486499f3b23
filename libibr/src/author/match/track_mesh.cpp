// SPDX-License-Identifier: Apache-2.0
#include "author/match/track_mesh.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "author/cgal/delaunay.h"
#include "author/match/plane_labels.h"
#include "author/match/vertices.h"
#include "base/raster.h"

namespace ibr {
namespace {

double area(const PlaneTrack& a, const PlaneTrack& b, const PlaneTrack& c, std::size_t member) {
  const glm::dvec2 u = b.at[member] - a.at[member], v = c.at[member] - a.at[member];
  return u.x * v.y - u.y * v.x;
}

struct Foldable {
  std::vector<PlaneTrack>& tracks;
  std::size_t members;

  std::size_t count() const { return tracks.size(); }
  std::vector<glm::uvec3> triangulate() const { return trackTriangles(tracks); }
  bool folded(const glm::uvec3& t) const {
    for (std::size_t i = 0; i < members; ++i)
      if (!(area(tracks[t.x], tracks[t.y], tracks[t.z], i) > 0)) return true;
    return false;
  }
  void keepOnly(const std::vector<bool>& keep) { ibr::keepOnly(tracks, keep); }
};

}  // namespace

std::vector<glm::uvec3> trackTriangles(std::span<const PlaneTrack> tracks) {
  std::vector<glm::dvec2> places;
  for (const PlaneTrack& track : tracks) places.push_back(track.at[0]);
  return delaunayTriangles(places);
}

std::vector<std::vector<std::uint32_t>> trackNeighbours(std::size_t count, std::span<const glm::uvec3> triangles) {
  std::vector<std::vector<std::uint32_t>> result(count);
  for (const glm::uvec3& t : triangles)
    for (int k = 0; k < 3; ++k)
      for (int l = 1; l < 3; ++l) result[t[k]].push_back(t[(k + l) % 3]);
  for (auto& list : result) {
    std::ranges::sort(list);
    list.erase(std::ranges::unique(list).begin(), list.end());
  }
  return result;
}

void dropContradicted(std::vector<PlaneTrack>& tracks, std::span<const PlaneMaps> planes, double px) {
  if (tracks.empty() || planes.empty()) return;
  const auto neighbours = trackNeighbours(tracks.size(), trackTriangles(tracks));
  std::vector<bool> keep(tracks.size(), true);
  for (std::size_t t = 0; t < tracks.size(); ++t) {
    double least = std::numeric_limits<double>::infinity();
    for (const std::uint32_t n : neighbours[t])
      if (tracks[n].plane >= 0) least = std::min(least, planes[std::size_t(tracks[n].plane)].error(tracks[t]));
    keep[t] = least <= px;
  }
  ibr::keepOnly(tracks, keep);
  dropFolded(tracks, planes[0].to.size());
}

void dropFolded(std::vector<PlaneTrack>& tracks, std::size_t members) {
  Foldable mesh{tracks, members};
  triangulateAndRepair(mesh);
}

std::vector<glm::u16vec4> planeLabels(std::span<const PlaneTrack> tracks, std::span<const PlaneMaps> planes,
                                      double px) {
  std::vector<glm::u16vec4> labels;
  std::vector<std::pair<double, std::uint16_t>> on;
  for (const PlaneTrack& track : tracks) {
    on.clear();
    for (std::size_t p = 0; p < planes.size(); ++p)
      if (const double error = planes[p].error(track); error < px)
        on.emplace_back(int(p) == track.plane ? 0.0 : error, std::uint16_t(p + 1));
    std::ranges::sort(on);
    if (on.size() > 4) on.resize(4);
    std::ranges::sort(on, {}, &std::pair<double, std::uint16_t>::second);
    glm::u16vec4 label(0);
    for (std::size_t k = 0; k < on.size(); ++k) label[int(k)] = on[k].second;
    labels.push_back(label);
  }
  return labels;
}

TrackField fieldOf(std::span<const PlaneTrack> tracks, std::span<const glm::uvec3> triangles,
                   std::span<const glm::u16vec4> labels, std::span<const PlaneMaps> planes, std::size_t members,
                   glm::ivec2 size) {
  TrackField field{std::vector<ImageF>(members, ImageF(size.x, size.y, 2, -1.0f)), Image8(size.x, size.y, 1)};
  for (const glm::uvec3& t : triangles) {
    const PlaneTrack &a = tracks[t.x], &b = tracks[t.y], &c = tracks[t.z];
    const std::uint16_t shared = commonPlane(labels[t.x], labels[t.y], labels[t.z]);
    // The plane misses the corners slightly: the residuals are interpolated over the triangle.
    std::array<std::array<glm::dvec2, kMaxMembers>, 3> left{a.at, b.at, c.at};
    bool onPlane = shared != 0;
    for (int k = 0; onPlane && k < 3; ++k) {
      const auto there = planes[shared - 1u](tracks[t[k]].at[0]);
      onPlane = there.has_value();
      for (std::size_t i = 0; onPlane && i < members; ++i) left[std::size_t(k)][i] -= (*there)[i];
    }
    forTrianglePixels(a.at[0], b.at[0], c.at[0], size.x, size.y, [&](int x, int y, const glm::dvec3& w) {
      const auto on = onPlane ? planes[shared - 1u](glm::dvec2(x + 0.5, y + 0.5)) : std::nullopt;
      if (onPlane && !on) return;
      field.known.pixel(x, y)[0] = 1;
      for (std::size_t i = 0; i < members; ++i) {
        glm::dvec2 at = w.x * left[0][i] + w.y * left[1][i] + w.z * left[2][i];
        if (on) at += (*on)[i];
        field.position[i].pixel(x, y)[0] = float(at.x);
        field.position[i].pixel(x, y)[1] = float(at.y);
      }
    });
  }
  return field;
}

}  // namespace ibr
