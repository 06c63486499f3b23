// SPDX-License-Identifier: Apache-2.0
#include "render/plan/cell_choice.h"

#include <algorithm>

namespace ibr {
namespace {

constexpr double kKeepDistance = 0.02;  // of a cell's size
constexpr double kKeepAngle = 0.02;     // radians, about a degree

class Order {
 public:
  explicit Order(const Scene& scene) : scene_(scene) {}

  bool better(const CellCandidate& a, const CellCandidate& b) const {
    if (a.extrapolation != b.extrapolation) return a.extrapolation < b.extrapolation;
    if (a.rotation != b.rotation) return a.rotation < b.rotation;
    return memberPoses(scene_, scene_.cells[a.cell]) < memberPoses(scene_, scene_.cells[b.cell]);
  }

  // With a bonus for those that were drawn before, which keeps this a strict order.
  bool deservesMore(const CellCandidate& a, const CellCandidate& b) const {
    if (a.nearlyInView != b.nearlyInView) return b.nearlyInView;
    if (a.first != b.first) return a.first;
    return better(favoured(a), favoured(b));
  }

  // Margins between pairs make no strict order.
  bool precedes(const CellCandidate& a, const CellCandidate& b) const {
    if (a.first != b.first) return a.first;
    if (a.rank < b.rank && b.rank != kNotShown) return !clearlyBetter(b, a);
    if (b.rank < a.rank && a.rank != kNotShown) return clearlyBetter(a, b);
    if (a.rank == kNotShown && b.rank == kNotShown) return better(a, b);
    return a.rank == kNotShown ? clearlyBetter(a, b) : !clearlyBetter(b, a);
  }

 private:
  static CellCandidate favoured(CellCandidate c) {
    if (c.rank == kNotShown) return c;
    c.extrapolation = std::max(0.0, c.extrapolation - kKeepDistance * c.size);
    c.rotation -= kKeepAngle;
    return c;
  }

  // By so much that their order changes.
  static bool clearlyBetter(const CellCandidate& a, const CellCandidate& b) {
    if (a.extrapolation != b.extrapolation) return a.extrapolation + kKeepDistance * a.size < b.extrapolation;
    return a.rotation + kKeepAngle < b.rotation;
  }

  const Scene& scene_;
};

}  // namespace

CellChoice chooseCells(const Scene& scene, std::vector<CellCandidate> candidates, std::size_t most) {
  const Order order(scene);
  std::ranges::sort(candidates, [&](const auto& a, const auto& b) { return order.deservesMore(a, b); });
  const auto end = candidates.begin() + std::ptrdiff_t(std::min(candidates.size(), most));
  CellChoice choice{{candidates.begin(), end}, {end, candidates.end()}};
  // By insertion into the order of the frame before.
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
