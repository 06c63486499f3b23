// SPDX-License-Identifier: Apache-2.0
#include "render/plan/culling.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>

#include "render/plan/correction.h"

namespace ibr {

std::array<glm::dvec3, 4> frustum(const Camera& view) {
  const Intrinsics& k = view.intrinsics;
  const double left = -k.cx / k.fx, right = (k.width - k.cx) / k.fx;
  const double bottom = (k.cy - k.height) / k.fy, top = k.cy / k.fy;
  const glm::dmat3 toWorld = glm::mat3_cast(view.pose.rotation);
  const auto plane = [&](glm::dvec3 normal) { return toWorld * glm::normalize(normal); };
  return {plane({1, 0, left}), plane({-1, 0, -right}), plane({0, 1, bottom}), plane({0, -1, -top})};
}

DirectionBounds::DirectionBounds(const CellPoses& cell, const CellBounds& bounds, const Placement& placement,
                                 const glm::dquat& axes)
    : shift_(0.0), ours_(placement.morph == Morph::ours) {
  const glm::dquat turn = glm::conjugate(placement.correction.rotation) * axes;
  for (std::size_t i = 0; i < cell.count; ++i) {
    if (placement.weights[i] == 0) continue;
    const Pose& pose = cell.pose[i];
    const CellBounds::Member& box = bounds.members[i];
    Member& member = members_[count_++];
    member.turn = placement.weights[i] * glm::mat3_cast(glm::conjugate(pose.rotation) * turn);
    member.low = ours_ ? box.low : box.unitLow;
    member.high = ours_ ? box.high : box.unitHigh;
    member.weight = std::abs(placement.weights[i]);
    shift_ += placement.weights[i] * (pose.position - placement.eye);
  }
  shift_ = ours_ ? double(bounds.maxInverseDistance) *
                       (glm::conjugate(axes) * corrected(placement.correction, shift_, placement.eye))
                 : glm::dvec3(0.0);
}

double DirectionBounds::most(glm::dvec3 n) const {
  double sum = std::max(0.0, glm::dot(n, shift_));
  for (std::size_t i = 0; i < count_; ++i) {
    const Member& member = members_[i];
    sum = mostInBox(member.turn * n, member.low, member.high, sum);
  }
  return sum;
}

double DirectionBounds::reach() const {
  double sum = glm::length(shift_);
  for (std::size_t i = 0; i < count_; ++i)
    sum += members_[i].weight *
           (ours_ ? glm::length(glm::max(glm::abs(members_[i].low), glm::abs(members_[i].high))) : 1.0);
  return sum;
}

bool mayBeVisible(const CellPoses& cell, const CellBounds& bounds, const std::array<glm::dvec3, 4>& planes,
                  const Placement& placement, double margin) {
  const DirectionBounds directions(cell, bounds, placement);
  const double reach = margin > 0 ? margin * directions.reach() : 0;
  return std::ranges::none_of(planes, [&](glm::dvec3 plane) { return directions.most(plane) + reach < 0.0; });
}

}  // namespace ibr
