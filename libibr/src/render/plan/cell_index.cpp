// SPDX-License-Identifier: Apache-2.0
#include "render/plan/cell_index.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>

#include "base/prefetch.h"
#include "render/plan/cell_distance.h"
#include "render/plan/culling.h"

namespace ibr {
namespace {

using TreeNode = CellIndex::Node;

// Relative margin of all tests: boxes of directions are stored as floats, weights sum to 1 within rounding.
constexpr double kMargin = 1e-6;

// TreeNode of a single cell, and a point by which cells are grouped: position in cell sizes, mean direction.
struct Entry {
  TreeNode node;
  std::array<double, 6> key{};
  std::uint32_t cell = 0;
};

Entry entryOf(const CellPoses& cell, const CellBounds& bounds, std::uint32_t index) {
  Entry entry;
  entry.cell = index;
  TreeNode& node = entry.node;
  node.low = node.high = cell.pose[0].position;
  node.minSize = node.maxSize = bounds.size;
  node.maxInverseDistance = bounds.maxInverseDistance;
  glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
  for (std::size_t i = 0; i < cell.count; ++i) {
    const Pose& pose = cell.pose[i];
    const CellBounds::Member& box = bounds.members[i];
    node.low = glm::min(node.low, pose.position);
    node.high = glm::max(node.high, pose.position);
    for (int corner = 0; corner < 8; ++corner) {
      const glm::dvec3 point(corner & 1 ? box.low.x : box.high.x, corner & 2 ? box.low.y : box.high.y,
                             corner & 4 ? box.low.z : box.high.z);
      const glm::dvec3 shown = pose.rotation * point;
      low = glm::min(low, shown);
      high = glm::max(high, shown);
      node.reach = std::max(node.reach, glm::length(point));
    }
  }
  node.shownLow = glm::vec3(low);
  node.shownHigh = glm::vec3(high);
  const glm::dvec3 middle = 0.5 * (low + high), position = 0.5 * (node.low + node.high);
  for (std::size_t a = 0; a < 3; ++a) {
    entry.key[a] = position[int(a)];
    entry.key[a + 3] = node.reach > 0 ? middle[int(a)] / node.reach : 0;
  }
  return entry;
}

void extend(TreeNode& node, const TreeNode& other) {
  node.low = glm::min(node.low, other.low);
  node.high = glm::max(node.high, other.high);
  node.shownLow = glm::min(node.shownLow, other.shownLow);
  node.shownHigh = glm::max(node.shownHigh, other.shownHigh);
  node.minSize = std::min(node.minSize, other.minSize);
  node.maxSize = std::max(node.maxSize, other.maxSize);
  node.reach = std::max(node.reach, other.reach);
  node.maxInverseDistance = std::max(node.maxInverseDistance, other.maxInverseDistance);
}

TreeNode boundsOf(std::span<const Entry> entries) {
  TreeNode node = entries.front().node;
  for (const Entry& entry : entries.subspan(1)) extend(node, entry.node);
  return node;
}

// Orders by the axis along which the entries differ most. Positions count in sizes of the largest cell.
auto orderOf(const TreeNode& node, std::span<const Entry> entries) {
  std::size_t widest = 0;
  double most = -1;
  for (std::size_t a = 0; a < 6; ++a) {
    const auto [low, high] = std::ranges::minmax_element(entries, {}, [a](const Entry& e) { return e.key[a]; });
    const double apart = (high->key[a] - low->key[a]) / (a < 3 ? std::max(node.maxSize, 1e-300) : 1.0);
    if (apart > most) most = apart, widest = a;
  }
  return [axis = widest](const Entry& a, const Entry& b) {
    return a.key[axis] != b.key[axis] ? a.key[axis] < b.key[axis] : a.cell < b.cell;
  };
}

// True if cellDistance is certainly beyond the limit for all cells of a node.
bool certainlyFar(const TreeNode& node, const CellQuery& query) {
  const glm::dvec3 eye = query.middle.position;
  const glm::dvec3 outside = (1 - kMargin) * glm::max(glm::max(node.low - eye, eye - node.high), glm::dvec3(0.0));
  const double limit = std::max(query.limit * node.maxSize, 0.0);  // NaN: nothing is beyond
  const double squared = glm::dot(outside, outside);
  if (!(squared > limit * limit)) return false;
  const double magnitude =
      std::max({largestCoordinate(eye), largestCoordinate(node.low), largestCoordinate(node.high)});
  // cellDistance counts smaller distances as 0.
  const double tolerance = std::max(2e-9 * node.maxSize, 16.0 * std::numeric_limits<double>::epsilon() * magnitude);
  return squared > tolerance * tolerance;
}

// True if cellDistance is certainly within the limit for all cells of a node.
bool certainlyNear(const TreeNode& node, const CellQuery& query) {
  const glm::dvec3 eye = query.middle.position;
  const double farthest = glm::length(glm::max(glm::abs(node.low - eye), glm::abs(node.high - eye)));
  return !((1 + kMargin) * farthest > query.limit * node.minSize);
}

// True if mayBeVisible is certainly false in the view for all cells of a node, with clamped weights and no correction.
bool certainlyOutside(const TreeNode& node, const CellQuery::View& view) {
  const glm::dvec3 low = node.low - view.eye, high = node.high - view.eye;
  const double farthest = glm::length(glm::max(glm::abs(low), glm::abs(high)));
  const double margin = kMargin * (node.reach + double(node.maxInverseDistance) * farthest);
  return std::ranges::any_of(view.planes, [&](glm::dvec3 plane) {
    const double most = double(node.maxInverseDistance) * std::max(0.0, mostInBox(plane, low, high)) +
                        mostInBox(plane, node.shownLow, node.shownHigh);
    return most < -margin;
  });
}

}  // namespace

CellIndex makeCellIndex(const Scene& scene, std::span<const CellBounds> cells, std::uint32_t leafSize) {
  std::vector<Entry> entries;
  entries.reserve(cells.size());
  CellIndex index;
  index.poses.reserve(cells.size());
  for (std::uint32_t c = 0; c < cells.size(); ++c)
    entries.push_back(entryOf(index.poses.emplace_back(cellPoses(scene, scene.cells[c])), cells[c], c));
  index.nodes = halvedTree(std::span(entries), leafSize, boundsOf, orderOf);
  for (const Entry& entry : entries) index.cells.push_back(entry.cell);
  return index;
}

CulledCells findCells(std::span<const CellBounds> bounds, const CellIndex& index, const CellQuery& query,
                      std::pmr::vector<std::uint32_t>& found) {
  struct Open {
    std::uint32_t node;
    bool outside;  // of all frusta
  };
  CulledCells culled;
  std::array<Open, kMaxHalvings> open;
  std::size_t count = 0;
  if (!index.nodes.empty()) open[count++] = {0, false};
  while (count > 0) {
    auto [at, outside] = open[--count];
    const TreeNode& node = index.nodes[at];
    ++culled.visitedNodes;
    if (certainlyFar(node, query)) {
      culled.byDistance += node.end - node.first;
      continue;
    }
    outside |= query.byFrustum && std::ranges::all_of(query.views, [&](const CellQuery::View& view) {
                 return certainlyOutside(node, view);
               });
    if (outside && certainlyNear(node, query)) {
      culled.byFrustum += node.end - node.first;
    } else if (node.second != 0) {
      prefetch(index.nodes[node.second]);
      open[count++] = {node.second, outside};
      open[count++] = {at + 1, outside};
    } else {
      for (std::uint32_t c = node.first; c < node.end; ++c) {
        const std::uint32_t cell = index.cells[c];
        if (!outside) {
          found.push_back(cell);
          continue;
        }
        const double size = bounds[cell].size;
        const bool far = cellDistance(index.poses[cell], size, query.middle).extrapolation > query.limit * size;
        ++(far ? culled.byDistance : culled.byFrustum);
      }
    }
  }
  std::ranges::sort(found);
  return culled;
}

}  // namespace ibr
