// SPDX-License-Identifier: Apache-2.0
#include "render/plan/cell_choice.h"

#include <algorithm>

#include "render/plan/cell_cover.h"

namespace ibr {
namespace {

constexpr double kDistanceHysteresis = 0.02;  // margin to overtake in extrapolation, of a cell's size
constexpr double kAngleHysteresis = 0.02;     // margin to overtake in rotation, radians, about 1°
constexpr double kWorthHysteresis = 1.1;      // factor on the worth of a cell that was drawn in the previous frame
constexpr double kHalfWorthDistance = 0.05;   // of the best cell's size: at this distance a cell is worth half
constexpr double kGatherWorth = 0.085;        // worth of the gather: a cell is better up to about half its size away
                                              // (libibr/docs/quality.md, "Cells chosen by what they add")

// Worth of the cell in each tile that it shows, > 0. `size`: of the best cell.
double worthOf(const CellCandidate& cell, double size) {
  const double worth = kHalfWorthDistance / (kHalfWorthDistance + (size > 0 ? cell.distance / size : 0.0));
  return cell.rank == kNotShown ? worth : kWorthHysteresis * worth;
}

class Order {
 public:
  explicit Order(const Scene& scene) : scene_(scene) {}

  bool better(const CellCandidate& a, const CellCandidate& b) const {
    if (a.extrapolation != b.extrapolation) return a.extrapolation < b.extrapolation;
    if (a.rotation != b.rotation) return a.rotation < b.rotation;
    return memberPoses(scene_, scene_.cells[a.cell]) < memberPoses(scene_, scene_.cells[b.cell]);
  }

  // Sorts with a bonus for cells of the previous frame. A bonus per cell, unlike a margin per pair, is a strict order.
  bool ranksBefore(const CellCandidate& a, const CellCandidate& b) const {
    if (a.nearlyInView != b.nearlyInView) return b.nearlyInView;
    if (a.first != b.first) return a.first;
    return better(withHysteresis(a), withHysteresis(b));
  }

  // Compares with margins between pairs, which is not a strict order: only for the insertion sort below.
  bool precedes(const CellCandidate& a, const CellCandidate& b) const {
    if (a.first != b.first) return a.first;
    if (a.rank < b.rank && b.rank != kNotShown) return !clearlyBetter(b, a);
    if (b.rank < a.rank && a.rank != kNotShown) return clearlyBetter(a, b);
    if (a.rank == kNotShown && b.rank == kNotShown) return better(a, b);
    return a.rank == kNotShown ? clearlyBetter(a, b) : !clearlyBetter(b, a);
  }

 private:
  static CellCandidate withHysteresis(CellCandidate c) {
    if (c.rank == kNotShown) return c;
    c.extrapolation = std::max(0.0, c.extrapolation - kDistanceHysteresis * c.size);
    c.rotation -= kAngleHysteresis;
    return c;
  }

  // True if `a` is better by more than the margin, so that the order of the two changes.
  static bool clearlyBetter(const CellCandidate& a, const CellCandidate& b) {
    if (a.extrapolation != b.extrapolation) return a.extrapolation + kDistanceHysteresis * a.size < b.extrapolation;
    return a.rotation + kAngleHysteresis < b.rotation;
  }

  const Scene& scene_;
};

}  // namespace

CellChoice chooseCells(const Scene& scene, const SceneBounds& bounds, std::span<const Camera> views,
                       std::vector<CellCandidate> candidates, std::size_t most, bool gathers) {
  const Order order(scene);
  std::ranges::sort(candidates, [&](const auto& a, const auto& b) { return order.ranksBefore(a, b); });
  std::vector<bool> chosen(candidates.size(), candidates.size() <= most && !gathers);
  if (gathers || candidates.size() > most) {
    std::vector<CellCover> covers;
    std::vector<double> worths;
    const std::size_t count = std::min(candidates.size(), std::max(most, kMaxCoverCandidates));
    std::size_t forced = count;
    for (std::size_t c = 0; c < count; ++c) {
      const CellCandidate& candidate = candidates[c];
      const std::uint32_t first = scene.cells[candidate.cell].members[0];
      covers.push_back(coverOf(bounds.cells[candidate.cell], scene.nodes[first].camera.pose.position, views));
      worths.push_back(worthOf(candidate, candidates[0].size));
      if (candidate.first) forced = c;
    }
    for (const std::size_t c : coveringCells(covers, worths, gathers ? kGatherWorth : 0.0, most, forced))
      chosen[c] = true;
  }
  CellChoice choice;
  for (std::size_t c = 0; c < candidates.size(); ++c) (chosen[c] ? choice.drawn : choice.left).push_back(candidates[c]);
  // Insertion sort, starting from the order of the previous frame.
  std::vector<CellCandidate>& drawn = choice.drawn;
  std::ranges::stable_sort(drawn, {}, &CellCandidate::rank);
  for (std::size_t i = 1; i < drawn.size(); ++i)
    for (std::size_t j = i; j > 0 && order.precedes(drawn[j], drawn[j - 1]); --j) std::swap(drawn[j], drawn[j - 1]);
  return choice;
}

std::vector<std::array<double, 7>> memberPoses(const Scene& scene, const Cell& cell) {
  std::vector<std::array<double, 7>> poses;
  for (std::uint32_t member : cell.members) {
    const Pose& pose = scene.nodes[member].camera.pose;
    poses.push_back({pose.position.x, pose.position.y, pose.position.z, pose.rotation.w, pose.rotation.x,
                     pose.rotation.y, pose.rotation.z});
  }
  std::sort(poses.begin(), poses.end());
  return poses;
}

}  // namespace ibr
