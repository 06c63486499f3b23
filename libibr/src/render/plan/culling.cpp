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
namespace {

// Returns the maximum of n·x over a box, n and x in the same axes.
double support(glm::dvec3 n, glm::vec3 low, glm::vec3 high) {
  double sum = 0;
  for (int a = 0; a < 3; ++a) sum += std::max(n[a] * low[a], n[a] * high[a]);
  return sum;
}

}  // namespace

std::array<glm::dvec3, 4> frustum(const Camera& view) {
  const Intrinsics& k = view.intrinsics;
  const double left = -k.cx / k.fx, right = (k.width - k.cx) / k.fx;
  const double bottom = (k.cy - k.height) / k.fy, top = k.cy / k.fy;
  const glm::dmat3 toWorld = glm::mat3_cast(view.pose.rotation);
  return {toWorld * glm::dvec3(1, 0, left), toWorld * glm::dvec3(-1, 0, -right), toWorld * glm::dvec3(0, 1, bottom),
          toWorld * glm::dvec3(0, -1, -top)};
}

// Bounds each term of n·D = Σ λ_i n·C R_i q_i + ρ n·t by itself, and |D| likewise.
bool mayBeVisible(const Scene& scene, const Cell& cell, const CellBounds& bounds,
                  const std::array<glm::dvec3, 4>& planes, const Placement& placement, double margin) {
  const bool ours = placement.morph == Morph::ours;
  glm::dvec3 shift(0.0);
  for (std::size_t i = 0; i < cell.members.size(); ++i)
    shift += placement.weights[i] * (scene.nodes[cell.members[i]].camera.pose.position - placement.eye);
  shift = corrected(placement.correction, shift, placement.eye);
  double reach = 0;
  for (std::size_t i = 0; margin > 0 && i < cell.members.size(); ++i) {
    const CellBounds::Member& box = bounds.members[i];
    reach += std::abs(placement.weights[i]) *
             (ours ? double(glm::length(glm::max(glm::abs(box.low), glm::abs(box.high)))) : 1.0);
  }
  if (ours) reach += bounds.maxInverseDistance * glm::length(shift);
  for (const glm::dvec3& plane : planes) {
    double most = ours ? std::max(0.0, bounds.maxInverseDistance * glm::dot(plane, shift)) : 0.0;
    if (margin > 0) most += margin * reach * glm::length(plane);
    const glm::dvec3 turned = glm::conjugate(placement.correction.rotation) * plane;
    for (std::size_t i = 0; i < cell.members.size(); ++i) {
      const CellBounds::Member& box = bounds.members[i];
      const glm::dvec3 n =
          placement.weights[i] * (glm::conjugate(scene.nodes[cell.members[i]].camera.pose.rotation) * turned);
      most += ours ? support(n, box.low, box.high) : support(n, box.unitLow, box.unitHigh);
    }
    if (most < 0.0) return false;
  }
  return true;
}

}  // namespace ibr
