// SPDX-License-Identifier: Apache-2.0
#include "render/plan/cell_choice.h"

#include <algorithm>
#include <array>
#include <compare>
#include <functional>
#include <utility>
#include <vector>

#include "render/plan/cell_cover.h"
#include "render/plan/scene_index.h"

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

// Sorted poses of a cell's members: an identity that does not depend on the order in the file.
struct MemberPoses {
  std::array<std::array<double, 7>, 4> poses{};
  std::size_t count = 0;

  explicit MemberPoses(const CellPoses& cell) {
    for (const auto& [position, rotation] : cell.poses()) {
      poses[count] = {position.x, position.y, position.z, rotation.w, rotation.x, rotation.y, rotation.z};
      for (std::size_t i = count++; i > 0 && poses[i] < poses[i - 1]; --i) std::swap(poses[i], poses[i - 1]);
    }
  }
  friend auto operator<=>(const MemberPoses& a, const MemberPoses& b) {
    return std::lexicographical_compare_three_way(a.poses.begin(), a.poses.begin() + std::ptrdiff_t(a.count),
                                                  b.poses.begin(), b.poses.begin() + std::ptrdiff_t(b.count));
  }
};

class Order {
 public:
  explicit Order(std::span<const CellPoses> poses) : poses_(poses) {}

  bool better(const CellCandidate& a, const CellCandidate& b) const {
    if (a.extrapolation != b.extrapolation) return a.extrapolation < b.extrapolation;
    if (a.rotation != b.rotation) return a.rotation < b.rotation;
    const auto order = MemberPoses(poses_[a.cell]) <=> MemberPoses(poses_[b.cell]);
    return order != 0 ? order < 0 : a.cell < b.cell;
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

  std::span<const CellPoses> poses_;  // as Scene::cells
};

}  // namespace

std::size_t chooseCells(const SceneBounds& bounds, std::span<const Camera> views, std::span<CellCandidate> candidates,
                        std::size_t most, bool gathers, std::pmr::memory_resource* memory) {
  const std::vector<CellPoses>& poses = bounds.index->cells.poses;
  const Order order(poses);
  const auto ranksBefore = [&](const auto& a, const auto& b) { return order.ranksBefore(a, b); };
  const std::size_t count = std::min(candidates.size(), std::max(most, kMaxCoverCandidates));
  const std::span<CellCandidate> considered = candidates.first(count);
  if (count < candidates.size())
    std::nth_element(candidates.begin(), candidates.begin() + std::ptrdiff_t(count), candidates.end(), ranksBefore);
  std::ranges::sort(considered, ranksBefore);
  std::size_t chosen = count;
  if (gathers || candidates.size() > most) {
    std::pmr::vector<double> worths(memory);
    std::size_t forced = count;
    for (std::size_t c = 0; c < count; ++c) {
      worths.push_back(worthOf(considered[c], considered[0].size));
      if (considered[c].first) forced = c;
    }
    const auto cover = [&](std::size_t c) {
      const std::uint32_t cell = considered[c].cell;
      return coverOf(bounds.cells[cell], poses[cell].pose[0].position, views);
    };
    const std::pmr::vector<std::size_t> covering = coveringCells(std::ref(cover), tilesOfViews(views.size()), worths,
                                                                 gathers ? kGatherWorth : 0.0, most, forced, memory);
    chosen = 0;  // the chosen ones are moved to the front, in their order
    for (const std::size_t c : covering) std::swap(considered[chosen++], considered[c]);
  }
  // Insertion sorts, the second of which starts from the order of the previous frame.
  const auto sort = [drawn = considered.first(chosen)](auto before) {
    for (std::size_t i = 1; i < drawn.size(); ++i)
      for (std::size_t j = i; j > 0 && before(drawn[j], drawn[j - 1]); --j) std::swap(drawn[j], drawn[j - 1]);
  };
  sort([](const CellCandidate& a, const CellCandidate& b) { return a.rank < b.rank; });
  sort([&](const CellCandidate& a, const CellCandidate& b) { return order.precedes(a, b); });
  return chosen;
}

}  // namespace ibr
