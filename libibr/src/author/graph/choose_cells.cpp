// SPDX-License-Identifier: Apache-2.0
#include "author/graph/choose_cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <limits>

#include "author/graph/capture_sites.h"

namespace ibr {
namespace {

constexpr std::uint32_t kMinSharedTracks = 30;  // tracks
constexpr double kMinCovisible = 0.10;          // of the tracks of the member with fewer
constexpr double kMinWideCovisible = 0.20;      // likewise, for a wide line
constexpr double kMaxWideDegrees = 45.0;        // max degrees between the axes of a wide line
constexpr int kMinCellsApart = 3;           // a wide line must join photographs more than this number of cells apart
constexpr double kMaxGoodSpread = 0.15;     // disparity spread in image widths; a larger one hides more
constexpr double kMinInsideWeight = -0.06;  // barycentric weights above this: inside another cell …
constexpr double kMaxSpanDistance = 0.05;   // … if the distance from its span is below this, in longest edges

bool hasFace(const Simplex& cell, const Simplex& face) {
  return std::includes(cell.begin(), cell.end(), face.begin(), face.end());
}

bool relativeNeighbours(const Views& views, const Simplex& edge, std::span<const std::uint32_t> others) {
  const auto at = cornersOf(views, edge);
  const double length = glm::distance(at[0], at[1]) * (1.0 - 1e-9);
  return std::none_of(others.begin(), others.end(), [&](std::uint32_t i) {
    const glm::dvec3 p = views[i].camera.pose.position;
    return std::max(glm::distance(p, at[0]), glm::distance(p, at[1])) < length;
  });
}

}  // namespace

const ViewRelation& CellJudge::between(std::uint32_t a, std::uint32_t b) const {
  return relations_.between(views_[a].image, views_[b].image);
}

std::optional<std::string> CellJudge::sharesTooLittle(std::uint32_t a, std::uint32_t b) const {
  if (!relations_.hasTracks()) return std::nullopt;
  const ViewRelation& relation = between(a, b);
  if (relation.shared >= kMinSharedTracks && relation.covisible() >= kMinCovisible) return std::nullopt;
  return fmt::format("{} and {} share {} of {} points; at least {} and {:.0f} % are needed", views_[a].name,
                     views_[b].name, relation.shared, relation.fewerTracks, kMinSharedTracks, 100 * kMinCovisible);
}

std::optional<std::string> CellJudge::refusal(const Simplex& simplex) const {
  if (!(shape(cornersOf(views_, simplex)) >= minShape(simplex.size()))) return "";
  for (std::size_t a = 0; a < simplex.size(); ++a)
    for (std::size_t b = a + 1; b < simplex.size(); ++b) {
      const std::uint32_t i = simplex[a], j = simplex[b];
      const double angle = axisAngle(views_, i, j), limit = std::min(views_[i].theta, views_[j].theta);
      if (angle > limit)
        return fmt::format("the viewing directions of {} and {} differ by {:.0f}°, more than {:.0f}°", views_[i].name,
                           views_[j].name, glm::degrees(angle), glm::degrees(limit));
      if (auto reason = sharesTooLittle(i, j)) return reason;
    }
  return std::nullopt;
}

bool CellJudge::acceptsWide(std::uint32_t a, std::uint32_t b) const {
  if (!views_.sameKind(a, b) || views_[a].site == views_[b].site) return false;
  const ViewRelation& relation = between(a, b);
  return relation.shared >= kMinSharedTracks && relation.covisible() >= kMinWideCovisible &&
         axisAngle(views_, a, b) <= glm::radians(kMaxWideDegrees);
}

double CellJudge::score(const Simplex& simplex) const {
  double covisible = 1, spread = 0;
  if (relations_.hasTracks())
    for (std::size_t a = 0; a < simplex.size(); ++a)
      for (std::size_t b = a + 1; b < simplex.size(); ++b) {
        const ViewRelation& relation = between(simplex[a], simplex[b]);
        covisible = std::min(covisible, relation.covisible());
        spread = std::max(spread, relation.disparitySpread);
      }
  return shape(cornersOf(views_, simplex)) * covisible * std::min(1.0, kMaxGoodSpread / std::max(spread, 1e-9));
}

bool liesIn(const Views& views, const Simplex& simplex, std::span<const Simplex> cells) {
  glm::dvec3 middle(0.0);
  for (const std::uint32_t i : simplex) middle += views[i].camera.pose.position / double(simplex.size());
  return std::any_of(cells.begin(), cells.end(), [&](const Simplex& cell) {
    const auto at = cornersOf(views, cell);
    const double longest = longestEdge(at);
    if (glm::distance(middle, at[0]) > (1 + kMaxSpanDistance) * longest) return false;
    if (axisAngle(views, simplex[0], cell[0]) > std::min(views[simplex[0]].theta, views[cell[0]].theta)) return false;
    const Location where = locate(at, middle);
    return where.distance < kMaxSpanDistance * longest &&
           std::all_of(where.weights.begin(), where.weights.begin() + std::ptrdiff_t(cell.size()),
                       [](double weight) { return weight > kMinInsideWeight; });
  });
}

std::vector<Simplex> chooseCells(const Views& views, const CellJudge& judge, const ViewGroup& group, GroupSplit split,
                                 std::map<Simplex, std::string>& refused) {
  // From the highest rank down; refused simplices are replaced by their faces. Delaunay simplices do not overlap.
  std::vector<Simplex> kept, candidates = std::move(split.simplices);
  bool mayOverlap = split.overlaps;
  for (std::size_t d = candidates.empty() ? 0 : candidates[0].size(); d >= 2; --d, mayOverlap = true) {
    std::vector<Simplex> level;
    std::set<Simplex> next;
    for (const Simplex& simplex : candidates) {
      if (const auto reason = judge.refusal(simplex)) {
        if (!reason->empty()) refused.emplace(simplex, *reason);
        if (d > 2)
          for (Simplex& face : faces(simplex)) next.insert(std::move(face));
        continue;
      }
      if (mayOverlap && (liesIn(views, simplex, kept) || liesIn(views, simplex, level))) continue;
      if (mayOverlap && d == 2 && !relativeNeighbours(views, simplex, group)) continue;
      level.push_back(simplex);
    }
    kept.insert(kept.end(), level.begin(), level.end());
    candidates.assign(next.begin(), next.end());
    std::erase_if(candidates, [&](const Simplex& face) {
      return std::any_of(kept.begin(), kept.end(), [&](const Simplex& cell) { return hasFace(cell, face); });
    });
  }
  return kept;
}

namespace {

// Graph of the views that cells connect.
class CellGraph {
 public:
  CellGraph(std::size_t views, const std::set<Simplex>& cells) : joined_(views) {
    for (const Simplex& cell : cells)
      for (const std::uint32_t i : cell)
        for (const std::uint32_t j : cell)
          if (i != j) joined_[i].insert(j);
    std::vector<TreeEdge> edges;
    for (std::uint32_t i = 0; i < views; ++i)
      for (const std::uint32_t j : joined_[i]) edges.push_back({1, i, j});
    component_ = components(views, edges);
  }
  /// True if the view has at most one neighbour.
  bool isEnd(std::uint32_t view) const { return joined_[view].size() <= 1; }
  bool connected(std::uint32_t a, std::uint32_t b) const { return component_[a] == component_[b]; }
  /// Views that at most `cells` cells connect to `seed`.
  std::set<std::uint32_t> within(std::uint32_t seed, int cells) const {
    std::set<std::uint32_t> reached{seed}, rim{seed};
    for (int step = 0; step < cells; ++step) {
      std::set<std::uint32_t> next;
      for (const std::uint32_t i : rim)
        for (const std::uint32_t j : joined_[i])
          if (reached.insert(j).second) next.insert(j);
      rim = std::move(next);
    }
    return reached;
  }

 private:
  std::vector<std::set<std::uint32_t>> joined_;
  std::vector<std::uint32_t> component_;
};

}  // namespace

std::vector<Simplex> wideLines(const Views& views, const CellJudge& judge, const ViewRelations& relations,
                               const std::set<Simplex>& cells) {
  std::vector<std::uint32_t> viewOf(views.size());
  for (std::uint32_t i = 0; i < views.size(); ++i) viewOf[views[i].image] = i;
  std::vector<std::vector<std::uint32_t>> partners(views.size());
  for (std::uint32_t i = 0; i < views.size(); ++i) {
    for (const auto& [image, shared] : relations.neighbours(views[i].image, kMinSharedTracks))
      if (judge.acceptsWide(i, viewOf[image])) partners[i].push_back(viewOf[image]);
    std::sort(partners[i].begin(), partners[i].end());
  }
  const CellGraph graph(views.size(), cells);
  std::set<Simplex> joinedSites;
  for (const Simplex& cell : cells)
    for (const std::uint32_t a : cell)
      for (const std::uint32_t b : cell) joinedSites.insert({views[a].site, views[b].site});
  std::vector<Simplex> lines;
  for (std::uint32_t i = 0; i < views.size(); ++i) {
    if (partners[i].empty()) continue;
    const std::set<std::uint32_t> near = graph.within(i, kMinCellsApart);
    for (const std::uint32_t j : partners[i]) {
      if (j < i || near.contains(j)) continue;
      if (graph.connected(i, j) && !graph.isEnd(i) && !graph.isEnd(j)) continue;
      if (joinedSites.contains({views[i].site, views[j].site})) continue;
      std::vector<std::uint32_t> ofBoth;
      std::set_intersection(partners[i].begin(), partners[i].end(), partners[j].begin(), partners[j].end(),
                            std::back_inserter(ofBoth));
      if (relativeNeighbours(views, {i, j}, ofBoth)) lines.push_back({i, j});
    }
  }
  return lines;
}

}  // namespace ibr
