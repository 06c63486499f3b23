// SPDX-License-Identifier: Apache-2.0
//
// Where the options ask for less than a group's rank, all faces (or edges) of the triangulation are candidates. Of each
// simplex those count whose size is within kSimilar of its smallest face, so that on a grid the cells lie in the grid's
// planes; no spot is left without one.
#include "author/cells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <limits>
#include <map>
#include <numeric>
#include <opencv2/core.hpp>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>

#include "author/delaunay.h"
#include "author/simplex.h"
#include "author/spots.h"
#include "base/check.h"

namespace ibr {
namespace {

constexpr double kFlat = 0.10;              // ratio of spreads below which a dimension does not count
constexpr double kLeastTriangle = 0.12;     // shape
constexpr double kLeastTetrahedron = 0.06;  // shape
constexpr std::uint32_t kLeastShared = 30;  // tracks
constexpr double kLeastSharedShare = 0.10;  // of the tracks of the poorer member
constexpr double kCovered = -0.06;          // weights above this: inside another cell …
constexpr double kNear = 0.05;              // … and no further off its span than this, in longest edges
constexpr double kBridge = 8.0;    // longer than so many median edges of the spanning tree: to something far off
constexpr double kMost = 0.8;      // of a group, that remain when that is cut off
constexpr double kSimilar = 1.25;  // ratio of areas

// The field of view along the shorter way, in radians.
double smallerFieldOfView(const Intrinsics& k) {
  if (k.model == CameraModel::equirectangular) return std::numbers::pi;
  return std::min(std::atan(k.cx / k.fx) + std::atan((k.width - k.cx) / k.fx),
                  std::atan(k.cy / k.fy) + std::atan((k.height - k.cy) / k.fy));
}

double leastShape(const Simplex& simplex) {
  return simplex.size() == 4 ? kLeastTetrahedron : simplex.size() == 3 ? kLeastTriangle : 1e-12;
}

double angleBetween(glm::dvec3 a, glm::dvec3 b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

// Positions about their mean, along their principal axes (greatest spread first), and the rank they span.
struct Frame {
  std::vector<glm::dvec3> positions;
  int rank = 0;
};

Frame principalFrame(std::vector<glm::dvec3> positions) {
  const glm::dvec3 mean =
      std::accumulate(positions.begin(), positions.end(), glm::dvec3(0.0)) / double(positions.size());
  double scale = 0;
  for (glm::dvec3& p : positions) {
    p -= mean;
    scale = std::max(scale, glm::length(p));
  }
  Frame frame{std::move(positions), 0};
  if (!(scale > 0)) return frame;
  cv::Matx33d covariance = cv::Matx33d::zeros();
  for (const glm::dvec3& p : frame.positions)
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) covariance(r, c) += p[r] / scale * (p[c] / scale);
  cv::Mat squares, axes;
  cv::eigen(covariance, squares, axes);  // descending
  auto spread = [&](int i) { return std::sqrt(std::max(squares.at<double>(i), 0.0)); };
  frame.rank = spread(2) >= kFlat * spread(0) ? 3 : spread(1) >= kFlat * spread(0) ? 2 : 1;
  for (glm::dvec3& p : frame.positions) {
    glm::dvec3 turned(0.0);
    for (int r = 0; r < 3; ++r) {
      const glm::dvec3 axis(axes.at<double>(r, 0), axes.at<double>(r, 1), axes.at<double>(r, 2));
      turned[r] = glm::dot(axis, p);
    }
    p = turned;
  }
  return frame;
}

class Planner {
 public:
  Planner(const PosedModel& model, const BuildOptions& options)
      : model_(model), cap_(options.dimension == 0 ? 3 : options.dimension), byName_(model.images.size()) {
    std::iota(byName_.begin(), byName_.end(), 0u);
    std::sort(byName_.begin(), byName_.end(),
              [&](std::uint32_t a, std::uint32_t b) { return model.images[a].name < model.images[b].name; });
    std::vector<std::uint32_t> rankOf(byName_.size());
    for (std::uint32_t r = 0; r < byName_.size(); ++r) rankOf[byName_[r]] = r;
    for (const std::uint32_t i : byName_) {
      const Camera& camera = model.images[i].camera;
      cameras_.push_back(camera);
      axis_.push_back(viewAxis(camera.pose));
      theta_.push_back(options.thetaDegrees > 0 ? glm::radians(options.thetaDegrees)
                                                : 0.5 * smallerFieldOfView(camera.intrinsics));
    }
    seen_.assign(cameras_.size(), 0);
    for (const Track& track : model.tracks)
      for (std::size_t a = 0; a < track.observations.size(); ++a) {
        const std::uint32_t i = rankOf[track.observations[a].image];
        ++seen_[i];
        for (std::size_t b = 0; b < a; ++b) ++shared_[key(i, rankOf[track.observations[b].image])];
      }
  }

  CellPlan run() {
    spot_ = findSpots(cameras_);
    spotCentre_.assign(cameras_.empty() ? 0 : 1 + *std::max_element(spot_.begin(), spot_.end()), glm::dvec3(0.0));
    std::vector<double> count(spotCentre_.size(), 0);
    for (std::size_t i = 0; i < cameras_.size(); ++i) {
      spotCentre_[spot_[i]] += cameras_[i].pose.position;
      ++count[spot_[i]];
    }
    for (std::size_t s = 0; s < count.size(); ++s) spotCentre_[s] /= count[s];

    std::set<std::vector<std::uint32_t>> groups, parts;
    for (std::uint32_t i = 0; i < cameras_.size(); ++i) groups.insert(groupAround(i));
    for (const auto& group : groups)
      if (group.size() >= 2)
        for (auto& part : clusters(group)) parts.insert(std::move(part));
    for (const auto& part : parts) triangulate(part);
    return report();
  }

 private:
  static std::uint64_t key(std::uint32_t a, std::uint32_t b) {
    return (std::uint64_t(std::min(a, b)) << 32) | std::max(a, b);
  }
  std::uint32_t shared(std::uint32_t a, std::uint32_t b) const {
    const auto found = shared_.find(key(a, b));
    return found == shared_.end() ? 0 : found->second;
  }
  std::vector<glm::dvec3> corners(const Simplex& simplex) const {
    std::vector<glm::dvec3> result;
    for (const std::uint32_t i : simplex) result.push_back(cameras_[i].pose.position);
    return result;
  }

  // It looks everywhere.
  bool isPanorama(std::uint32_t i) const { return cameras_[i].intrinsics.model == CameraModel::equirectangular; }

  std::vector<std::uint32_t> groupAround(std::uint32_t seed) const {
    std::map<std::uint32_t, std::pair<double, std::uint32_t>> best;  // of each spot: angle, image
    for (std::uint32_t i = 0; i < cameras_.size(); ++i) {
      if (isPanorama(i) != isPanorama(seed)) continue;
      const double angle = i == seed ? -1.0 : isPanorama(i) ? 0.0 : angleBetween(axis_[seed], axis_[i]);
      if (angle > std::min(theta_[seed], theta_[i])) continue;
      const auto [at, added] = best.emplace(spot_[i], std::pair(angle, i));
      if (!added) at->second = std::min(at->second, std::pair(angle, i));
    }
    std::vector<std::uint32_t> group;
    for (const auto& [spot, choice] : best) group.push_back(choice.second);
    std::sort(group.begin(), group.end());
    return group;
  }

  // A group without photographs far off: one of them would decide the rank of all. What was cut off follows, and the
  // bridges to it as pairs. A group that falls into parts of like size stays whole.
  std::vector<std::vector<std::uint32_t>> clusters(const std::vector<std::uint32_t>& group) const {
    std::vector<glm::dvec3> places;
    for (const std::uint32_t i : group) places.push_back(spotCentre_[spot_[i]]);
    const std::vector<TreeEdge> tree = spanningTree(places);
    const double limit = kBridge * tree[tree.size() / 2].length;
    const auto bridges =
        std::find_if(tree.begin(), tree.end(), [&](const TreeEdge& edge) { return edge.length > limit; });
    const auto cluster = components(group.size(), std::span(tree.begin(), bridges));
    std::vector<std::vector<std::uint32_t>> parts(1 + *std::max_element(cluster.begin(), cluster.end()));
    for (std::size_t k = 0; k < group.size(); ++k) parts[cluster[k]].push_back(group[k]);
    const auto largest =
        std::max_element(parts.begin(), parts.end(), [](const auto& a, const auto& b) { return a.size() < b.size(); });
    if (double(largest->size()) < kMost * double(group.size())) return {group};
    for (auto edge = bridges; edge != tree.end(); ++edge)
      parts.push_back({std::min(group[edge->a], group[edge->b]), std::max(group[edge->a], group[edge->b])});
    std::erase_if(parts, [](const auto& part) { return part.size() < 2; });
    return parts;
  }

  // Simplices of the rank that the group's places span, by image.
  std::vector<Simplex> delaunay(const std::vector<std::uint32_t>& group) const {
    std::vector<glm::dvec3> places;
    for (const std::uint32_t i : group) places.push_back(spotCentre_[spot_[i]]);
    const Frame frame = principalFrame(std::move(places));
    std::vector<Simplex> simplices;
    if (frame.rank == 3) {
      for (const glm::uvec4& t : delaunayTetrahedra(frame.positions))
        simplices.push_back({group[t.x], group[t.y], group[t.z], group[t.w]});
    } else if (frame.rank == 2) {
      std::vector<glm::dvec2> flat(frame.positions.begin(), frame.positions.end());
      for (const glm::uvec3& t : delaunayTriangles(flat)) simplices.push_back({group[t.x], group[t.y], group[t.z]});
    } else if (frame.rank == 1) {
      std::vector<std::uint32_t> order(group.size());
      std::iota(order.begin(), order.end(), 0u);
      std::sort(order.begin(), order.end(),
                [&](std::uint32_t a, std::uint32_t b) { return frame.positions[a].x < frame.positions[b].x; });
      for (std::size_t k = 1; k < order.size(); ++k) simplices.push_back({group[order[k - 1]], group[order[k]]});
    }
    for (Simplex& simplex : simplices) std::sort(simplex.begin(), simplex.end());
    std::sort(simplices.begin(), simplices.end());
    return simplices;
  }

  // nullopt: accepted. "": a sliver, which needs no words. Else the reason.
  std::optional<std::string> refusal(const Simplex& simplex) const {
    if (!(shape(corners(simplex)) >= leastShape(simplex))) return "";
    for (std::size_t a = 0; a < simplex.size(); ++a)
      for (std::size_t b = a + 1; b < simplex.size(); ++b) {
        const std::uint32_t i = simplex[a], j = simplex[b];
        const double angle = angleBetween(axis_[i], axis_[j]), limit = std::min(theta_[i], theta_[j]);
        if (angle > limit && !isPanorama(i))
          return fmt::format("{} and {} look {:.0f}° apart, more than {:.0f}°", name(i), name(j), glm::degrees(angle),
                             glm::degrees(limit));
        if (model_.tracks.empty()) continue;
        const std::uint32_t count = shared(i, j), poorer = std::min(seen_[i], seen_[j]);
        if (count < kLeastShared || count < kLeastSharedShare * poorer)
          return fmt::format("{} and {} share {} points of {}; {} and {:.0f} % are needed", name(i), name(j), count,
                             poorer, kLeastShared, 100 * kLeastSharedShare);
      }
    return std::nullopt;
  }
  bool accepted(const Simplex& simplex) {
    const auto reason = refusal(simplex);
    if (reason && !reason->empty()) refused_.emplace(simplex, *reason);
    return !reason;
  }

  // Whether the middle of a simplex lies in another cell of the group.
  bool covered(const Simplex& simplex, const std::vector<Simplex>& by) const {
    glm::dvec3 middle(0.0);
    for (const std::uint32_t i : simplex) middle += cameras_[i].pose.position / double(simplex.size());
    return std::any_of(by.begin(), by.end(), [&](const Simplex& other) {
      const auto at = corners(other);
      const Location where = locate(at, middle);
      return where.distance < kNear * longestEdge(at) &&
             std::all_of(where.weights.begin(), where.weights.begin() + std::ptrdiff_t(other.size()),
                         [](double weight) { return weight > kCovered; });
    });
  }
  bool relativeNeighbours(const Simplex& edge, const std::vector<std::uint32_t>& group) const {
    const auto at = corners(edge);
    const double length = glm::distance(at[0], at[1]) * (1.0 - 1e-9);
    return std::none_of(group.begin(), group.end(), [&](std::uint32_t i) {
      const glm::dvec3 p = cameras_[i].pose.position;
      return std::max(glm::distance(p, at[0]), glm::distance(p, at[1])) < length;
    });
  }

  // The faces (d members) of simplices with more members, where the options ask for cells of at most d.
  std::vector<Simplex> lowered(const std::vector<Simplex>& simplices, std::size_t d) const {
    if (simplices.empty() || simplices[0].size() <= d) return simplices;
    auto size = [&](const Simplex& face) {
      const auto at = corners(face);
      return face.size() == 3 ? glm::length(glm::cross(at[1] - at[0], at[2] - at[0])) : glm::distance(at[0], at[1]);
    };
    std::map<Simplex, bool> candidates;  // → similar to the smallest face of one of its simplices
    for (const Simplex& simplex : simplices) {
      if (d == 3 && shape(corners(simplex)) < leastShape(simplex)) continue;  // its faces lie across each other
      std::vector<Simplex> parts = faces(simplex);
      if (parts[0].size() > d) {
        std::vector<Simplex> edges;
        for (const Simplex& part : parts)
          for (const Simplex& edge : faces(part)) edges.push_back(edge);
        parts = std::move(edges);
      }
      double smallest = std::numeric_limits<double>::infinity();
      for (const Simplex& part : parts) smallest = std::min(smallest, size(part));
      for (const Simplex& part : parts) candidates[part] |= d == 2 || size(part) <= kSimilar * smallest;
    }
    std::vector<std::pair<double, Simplex>> bySize;
    std::set<std::uint32_t> reached;
    for (const auto& [part, similar] : candidates) {
      bySize.emplace_back(size(part), part);
      if (similar) reached.insert(part.begin(), part.end());
    }
    std::sort(bySize.begin(), bySize.end());
    std::vector<Simplex> result;
    for (const auto& [area, part] : bySize) {
      const bool lonely = std::any_of(part.begin(), part.end(), [&](std::uint32_t i) { return !reached.contains(i); });
      if (!candidates[part] && !lonely) continue;
      reached.insert(part.begin(), part.end());
      result.push_back(part);
    }
    return result;
  }

  void triangulate(const std::vector<std::uint32_t>& group) {
    if (group.size() < 2) return;
    std::vector<Simplex> candidates = delaunay(group);
    if (candidates.empty()) return;
    const std::size_t most = std::size_t(cap_) + 1;
    bool mayOverlap = candidates[0].size() > most;  // Delaunay simplices do not
    if (mayOverlap) candidates = lowered(candidates, most);

    // From the highest rank downwards; what is refused hands its faces on.
    std::vector<Simplex> kept;
    for (std::size_t d = candidates.empty() ? 0 : candidates[0].size(); d >= 2; --d, mayOverlap = true) {
      std::vector<Simplex> refusedHere, level;
      for (const Simplex& simplex : candidates) {
        if (!accepted(simplex)) {
          refusedHere.push_back(simplex);
          continue;
        }
        if (mayOverlap && (covered(simplex, kept) || covered(simplex, level))) continue;
        if (mayOverlap && d == 2 && !relativeNeighbours(simplex, group)) continue;
        level.push_back(simplex);
      }
      kept.insert(kept.end(), level.begin(), level.end());
      std::set<Simplex> next;
      if (d > 2)
        for (const Simplex& simplex : refusedHere)
          for (const Simplex& face : faces(simplex)) next.insert(face);
      candidates.assign(next.begin(), next.end());
      std::erase_if(candidates, [&](const Simplex& face) {
        return std::any_of(kept.begin(), kept.end(), [&](const Simplex& cell) {
          return std::includes(cell.begin(), cell.end(), face.begin(), face.end());
        });
      });
    }
    cells_.insert(kept.begin(), kept.end());
  }

  const std::string& name(std::uint32_t i) const { return model_.images[byName_[i]].name; }
  std::string names(const Simplex& simplex) const {
    std::string text;
    for (const std::uint32_t i : simplex) text += (text.empty() ? "" : ", ") + name(i);
    return text;
  }

  CellPlan report() const {
    CellPlan plan;
    plan.ordered = 2 * spotCentre_.size() <= cameras_.size();
    std::vector<bool> used(cameras_.size(), false);
    for (const Simplex& cell : cells_) {
      plan.cells.emplace_back();
      for (const std::uint32_t i : cell) {
        plan.cells.back().push_back(byName_[i]);
        used[i] = true;
      }
    }
    std::vector<std::string> reason(cameras_.size());
    for (const auto& [simplex, why] : refused_) {
      if (!cells_.contains(simplex)) plan.dropped.push_back({names(simplex), why});
      if (simplex.size() == 2)
        for (const std::uint32_t i : simplex)
          if (reason[i].empty()) reason[i] = why;
    }
    for (std::uint32_t i = 0; i < cameras_.size(); ++i) {
      if (used[i]) continue;
      if (reason[i].empty())
        reason[i] = groupAround(i).size() < 2
                        ? fmt::format("no photograph from another place looks within {:.0f}° of its direction",
                                      glm::degrees(theta_[i]))
                        : "it spans no cell of good shape with its neighbours";
      plan.dropped.push_back({name(i), "in no cell: " + reason[i]});
    }
    return plan;
  }

  const PosedModel& model_;
  const int cap_;
  // All that follows is in the order of names.
  std::vector<std::uint32_t> byName_;  // → index into model_.images
  std::vector<Camera> cameras_;
  std::vector<glm::dvec3> axis_;
  std::vector<double> theta_;  // radians
  std::vector<std::uint32_t> seen_;
  std::unordered_map<std::uint64_t, std::uint32_t> shared_;
  std::vector<std::uint32_t> spot_;
  std::vector<glm::dvec3> spotCentre_;
  std::set<Simplex> cells_;
  std::map<Simplex, std::string> refused_;
};

}  // namespace

CellPlan planCells(const PosedModel& model, const BuildOptions& options) {
  check(options.dimension >= 0 && options.dimension <= 3, ErrorCode::invalidInput, "dimension {} is not 0 to 3",
        options.dimension);
  check(options.thetaDegrees >= 0 && options.thetaDegrees <= 180, ErrorCode::invalidInput,
        "theta {} is not within 0 to 180 degrees", options.thetaDegrees);
  return Planner(model, options).run();
}

}  // namespace ibr
