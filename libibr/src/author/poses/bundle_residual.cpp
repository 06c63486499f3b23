// SPDX-License-Identifier: Apache-2.0
#include "author/poses/bundle_residual.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "author/poses/bundle_adjust.h"

namespace ibr {
namespace {

glm::dvec3 vec(const double* v) {
  return {v[0], v[1], v[2]};
}

glm::dquat turnedBy(const glm::dvec3& by) {
  const double angle = glm::length(by);
  return angle > 0 ? glm::angleAxis(angle, by / angle) : glm::dquat(1, 0, 0, 0);
}

// J_r: exp(δ + ε) = exp(δ) exp(J_r ε) to first order (Solà et al. 2018, eq. 143). By a series for small δ.
glm::dmat3 rightJacobian(const glm::dvec3& delta) {
  const double square = glm::dot(delta, delta), angle = std::sqrt(square);
  const double one = angle > 1e-4 ? (1 - std::cos(angle)) / square : 0.5 - square / 24;
  const double two = angle > 1e-4 ? (angle - std::sin(angle)) / (square * angle) : 1.0 / 6 - square / 120;
  const glm::dmat3 cross(0, delta.z, -delta.y, -delta.z, 0, delta.x, delta.y, -delta.x, 0);  // column by column
  return glm::dmat3(1.0) - one * cross + two * cross * cross;
}

}  // namespace

AnchoredPoint anchorPoint(const glm::dvec4& position, const glm::dvec3& anchor) {
  const glm::dvec3 way = glm::dvec3(position) - position.w * anchor;
  const double length = glm::length(way);
  const glm::dvec3 u = way / length;
  const glm::dvec3 aside = std::abs(u.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 e1 = glm::normalize(glm::cross(u, aside));
  return {anchor, u, e1, glm::cross(u, e1), position.w / length};
}

glm::dvec4 placedPoint(const AnchoredPoint& point, const double* unknowns) {
  const glm::dvec3 way = point.direction + unknowns[0] * point.e1 + unknowns[1] * point.e2;
  const double w = std::max(unknowns[2], 0.0);  // divergent rays meet at infinity
  return {way + w * point.anchor, w};
}

Camera movedCamera(const Camera& start, const double* pose, const double* lens) {
  Camera camera = start;
  camera.pose.rotation = glm::normalize(start.pose.rotation * turnedBy(vec(pose)));
  camera.pose.position += vec(pose + 3);
  camera.intrinsics.fx *= std::exp(lens[0]);
  camera.intrinsics.fy *= std::exp(lens[0]);
  camera.intrinsics.cx += lens[1];
  camera.intrinsics.cy += lens[2];
  return camera;
}

std::optional<glm::dvec2> seenAt(const Camera& camera, const glm::dvec4& point) {
  return project(camera.intrinsics,
                 glm::conjugate(camera.pose.rotation) * (glm::dvec3(point) - point.w * camera.pose.position));
}

std::optional<BundleResidual> bundleResidual(const Camera& start, const AnchoredPoint& point, glm::dvec2 pixel,
                                             const double* pose, const double* lens, const double* pointUnknowns,
                                             bool derivatives) {
  const Camera camera = movedCamera(start, pose, lens);
  const Intrinsics& k = camera.intrinsics;
  const glm::dmat3 toCamera = glm::mat3_cast(glm::conjugate(camera.pose.rotation));
  const glm::dvec3 shift = toCamera * (point.anchor - camera.pose.position);
  const glm::dvec3 q = toCamera * (point.direction + pointUnknowns[0] * point.e1 + pointUnknowns[1] * point.e2) +
                       pointUnknowns[2] * shift;
  if (!(q.z < 0)) return std::nullopt;
  const glm::dvec2 fromCentre(-k.fx * q.x / q.z, k.fy * q.y / q.z);
  BundleResidual found;
  found.off = glm::dvec2(k.cx, k.cy) + fromCentre - pixel;
  if (!derivatives) return found;

  const std::array<glm::dvec3, 2> byPosition{glm::dvec3(-k.fx / q.z, 0, -fromCentre.x / q.z),
                                             glm::dvec3(0, k.fy / q.z, -fromCentre.y / q.z)};
  const glm::dmat3 turning = rightJacobian(vec(pose));
  const glm::dvec3 e1 = toCamera * point.e1, e2 = toCamera * point.e2;
  for (int r = 0; r < 2; ++r) {
    const glm::dvec3& g = byPosition[std::size_t(r)];
    const glm::dvec3 byTurn = glm::transpose(turning) * glm::cross(g, q);  // a rotation by ε moves q by q × J_r ε
    const glm::dvec3 byShift = -pointUnknowns[2] * (glm::transpose(toCamera) * g);
    found.poseJacobian[std::size_t(r)] = {byTurn.x, byTurn.y, byTurn.z, byShift.x, byShift.y, byShift.z};
    found.lensJacobian[std::size_t(r)] = {fromCentre[r], r == 0 ? 1.0 : 0.0, r == 1 ? 1.0 : 0.0};
    found.pointJacobian[std::size_t(r)] = {glm::dot(g, e1), glm::dot(g, e2), glm::dot(g, shift)};
  }
  return found;
}

}  // namespace ibr
