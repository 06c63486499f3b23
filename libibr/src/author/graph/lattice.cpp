// SPDX-License-Identifier: Apache-2.0
#include "author/graph/lattice.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <numeric>
#include <opencv2/core.hpp>
#include <set>

#include "author/cgal/delaunay.h"
#include "author/graph/capture_sites.h"

namespace ibr {
namespace {

constexpr double kMinAxisCosine = 0.9397;       // cos 20°: max angle between tree edges along one axis
constexpr double kMaxRightAngleCosine = 0.139;  // cos 82°: axes are at right angles to within 8°
constexpr double kMaxLevelWidth = 0.3;          // max width of a level, in shortest steps along its axis
constexpr double kMinFilledShare = 0.6;         // min share of the grid's positions that exist

struct Axis {
  glm::dvec3 direction;
  double step;  // shortest edge of the tree along the axis
};

// Common direction of edges of any sign.
glm::dvec3 commonDirection(std::span<const glm::dvec3> edges) {
  cv::Matx33d sum = cv::Matx33d::zeros();
  for (const glm::dvec3& edge : edges) {
    const glm::dvec3 unit = glm::normalize(edge);
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) sum(r, c) += unit[r] * unit[c];
  }
  cv::Mat values, vectors;
  cv::eigen(sum, values, vectors);
  return {vectors.at<double>(0, 0), vectors.at<double>(0, 1), vectors.at<double>(0, 2)};
}

// Axes, longest steps first; empty unless all edges run along at most three axes at right angles.
std::vector<Axis> axesOf(std::vector<glm::dvec3> edges) {
  std::vector<Axis> axes;
  while (!edges.empty()) {
    if (axes.size() == 3) return {};
    // Noise rotates long edges least.
    const glm::dvec3 seed = glm::normalize(*std::max_element(
        edges.begin(), edges.end(), [](glm::dvec3 a, glm::dvec3 b) { return glm::dot(a, a) < glm::dot(b, b); }));
    const auto others = std::partition(edges.begin(), edges.end(), [&](glm::dvec3 edge) {
      return std::abs(glm::dot(glm::normalize(edge), seed)) > kMinAxisCosine;
    });
    Axis axis{commonDirection({edges.begin(), others}), std::numeric_limits<double>::infinity()};
    for (auto edge = edges.begin(); edge != others; ++edge) axis.step = std::min(axis.step, glm::length(*edge));
    for (const Axis& other : axes)
      if (std::abs(glm::dot(other.direction, axis.direction)) > kMaxRightAngleCosine) return {};
    axes.push_back(axis);
    edges.erase(edges.begin(), others);
  }
  return axes;
}

// Level of each coordinate, from 0; empty if the coordinates do not form levels at this step.
std::vector<int> levelsOf(const std::vector<double>& coordinates, double step) {
  std::vector<std::size_t> order(coordinates.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return coordinates[a] < coordinates[b]; });
  std::vector<int> levels(coordinates.size(), 0);
  double lowest = coordinates[order[0]];
  int level = 0;
  for (std::size_t k = 1; k < order.size(); ++k) {
    if (coordinates[order[k]] - coordinates[order[k - 1]] > 0.5 * step) {
      ++level;
      lowest = coordinates[order[k]];
    }
    if (coordinates[order[k]] - lowest > kMaxLevelWidth * step) return {};
    levels[order[k]] = level;
  }
  // Fixes the direction, so that the sign of the axis has no effect.
  for (const int its : levels) {
    if (2 * its == level) continue;
    if (2 * its > level)
      for (int& turned : levels) turned = level - turned;
    break;
  }
  return levels;
}

// Coordinates along axes that are not exactly at right angles.
std::vector<std::vector<double>> coordinatesOf(std::span<const glm::dvec3> positions, const std::vector<Axis>& axes) {
  glm::dmat3 frame(1.0);
  for (std::size_t a = 0; a < axes.size(); ++a) frame[int(a)] = axes[a].direction;
  if (axes.size() == 1) {
    const glm::dvec3 aside = std::abs(frame[0].x) < 0.7 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    frame[1] = glm::normalize(glm::cross(frame[0], aside));
  }
  if (axes.size() < 3) frame[2] = glm::normalize(glm::cross(frame[0], frame[1]));
  const glm::dmat3 inverse = glm::inverse(frame);
  std::vector<std::vector<double>> coordinates(3);
  for (const glm::dvec3& position : positions)
    for (int a = 0; a < 3; ++a) coordinates[std::size_t(a)].push_back((inverse * (position - positions[0]))[a]);
  return coordinates;
}

// Lattice whose steps, and their negated sum, are at obtuse angles to each other: A* in space, nearly so in the plane.
// Integer coordinates make collinear positions exactly collinear.
glm::dvec3 laidOut(const std::array<int, 3>& levels, int rank) {
  const double i = levels[0], j = levels[1], k = levels[2];
  if (rank == 1) return {i, 0, 0};
  if (rank == 2) return {2 * i - j, 2 * j, 0};
  return {i - j - k, -i + j - k, -i - j + k};
}

}  // namespace

std::optional<Lattice> findLattice(std::span<const glm::dvec3> positions) {
  if (positions.size() < 3) return std::nullopt;
  const std::vector<TreeEdge> tree = spanningTree(positions);
  if (!(tree.front().length > 1e-9 * tree.back().length)) return std::nullopt;
  std::vector<glm::dvec3> edges;
  for (const TreeEdge& edge : tree) edges.push_back(positions[edge.a] - positions[edge.b]);
  std::vector<Axis> axes = axesOf(std::move(edges));
  if (axes.empty()) return std::nullopt;

  Lattice lattice{int(axes.size()), std::vector<std::array<int, 3>>(positions.size(), {0, 0, 0})};
  const std::vector<std::vector<double>> coordinates = coordinatesOf(positions, axes);
  double whole = 1;
  std::vector<std::vector<int>> levels;
  const double shortest =
      std::min_element(axes.begin(), axes.end(), [](const Axis& a, const Axis& b) { return a.step < b.step; })->step;
  for (std::size_t a = 0; a < 3; ++a) {
    levels.push_back(levelsOf(coordinates[a], a < axes.size() ? axes[a].step : shortest));
    if (levels[a].empty()) return std::nullopt;
    const int count = 1 + *std::max_element(levels[a].begin(), levels[a].end());
    if ((count > 1) != (a < axes.size())) return std::nullopt;
    whole *= count;
  }
  if (double(positions.size()) < kMinFilledShare * whole) return std::nullopt;

  // Sorts the axes by the levels of the first positions, so that the world's rotation has no effect.
  std::vector<std::size_t> order(axes.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return levels[a] < levels[b]; });
  std::set<std::array<int, 3>> taken;
  for (std::size_t p = 0; p < positions.size(); ++p) {
    for (std::size_t a = 0; a < order.size(); ++a) lattice.levels[p][a] = levels[order[a]][p];
    if (!taken.insert(lattice.levels[p]).second) return std::nullopt;
  }
  return lattice;
}

int extent(const Lattice& lattice, std::span<const std::uint32_t> positions) {
  int axes = 0;
  for (std::size_t a = 0; a < 3; ++a)
    axes += std::any_of(positions.begin(), positions.end(),
                        [&](std::uint32_t p) { return lattice.levels[p][a] != lattice.levels[positions[0]][a]; });
  return axes;
}

std::vector<Simplex> splitLattice(const Lattice& lattice, std::span<const std::uint32_t> chosen) {
  std::vector<glm::dvec3> points;
  for (const std::uint32_t p : chosen) points.push_back(laidOut(lattice.levels[p], lattice.rank));
  std::vector<Simplex> simplices;
  const int rank = extent(lattice, chosen);
  if (rank == 3) {
    for (const glm::uvec4& t : delaunayTetrahedra(points)) simplices.push_back({t.x, t.y, t.z, t.w});
  } else if (rank == 2) {
    // Two of the three axes, laid out in the plane.
    std::size_t first = 0, second = 1;
    const auto flat = [&](std::size_t a) {
      return std::all_of(chosen.begin(), chosen.end(),
                         [&](std::uint32_t p) { return lattice.levels[p][a] == lattice.levels[chosen[0]][a]; });
    };
    if (flat(0))
      first = 1, second = 2;
    else if (flat(1))
      second = 2;
    std::vector<glm::dvec2> plane;
    for (const std::uint32_t p : chosen)
      plane.emplace_back(laidOut({lattice.levels[p][first], lattice.levels[p][second], 0}, 2));
    for (const glm::uvec3& t : delaunayTriangles(plane)) simplices.push_back({t.x, t.y, t.z});
  } else if (rank == 1) {
    std::vector<std::uint32_t> order(chosen.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t a, std::uint32_t b) { return lattice.levels[chosen[a]] < lattice.levels[chosen[b]]; });
    for (std::size_t k = 1; k < order.size(); ++k) simplices.push_back({order[k - 1], order[k]});
  }
  for (Simplex& simplex : simplices) std::sort(simplex.begin(), simplex.end());
  std::sort(simplices.begin(), simplices.end());
  return simplices;
}

}  // namespace ibr
