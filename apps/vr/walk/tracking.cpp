// SPDX-License-Identifier: Apache-2.0
#include "vr/walk/tracking.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

namespace ibr::app {
namespace {

constexpr double kVertical = 0.1;  // min. sine of the angle to the vertical; below: counts as straight up or down

glm::dvec3 below(glm::dvec3 head, double height = 0) {
  return {head.x, height, head.z};
}

glm::dquat aboutY(double radians) {
  return glm::angleAxis(radians, glm::dvec3(0, 1, 0));
}

// Shifts `tracking`, which was turned or scaled, so that `point` of the tracking space stays where `before` has it.
Tracking pinned(Tracking tracking, const Tracking& before, glm::dvec3 point) {
  tracking.origin = before.origin + before.rotation * (before.unitsPerMetre * point) -
                    tracking.rotation * (tracking.unitsPerMetre * point);
  return tracking;
}

// Returns the shortest rotation of y to `up`.
glm::dquat upright(glm::dvec3 up) {
  const glm::dvec3 y(0, 1, 0);
  if (up.y < -1 + 1e-12) return {0, 1, 0, 0};
  return glm::normalize(glm::dquat(1 + glm::dot(y, up), glm::cross(y, up)));
}

}  // namespace

glm::dvec3 inWorld(const Tracking& tracking, glm::dvec3 point) {
  return tracking.origin + tracking.rotation * (tracking.unitsPerMetre * point);
}

Pose inWorld(const Tracking& tracking, const Pose& pose) {
  return {inWorld(tracking, pose.position), glm::normalize(tracking.rotation * pose.rotation)};
}

glm::dvec3 inTracking(const Tracking& tracking, glm::dvec3 point) {
  return glm::conjugate(tracking.rotation) * ((point - tracking.origin) / tracking.unitsPerMetre);
}

Pose inTracking(const Tracking& tracking, const Pose& pose) {
  return {inTracking(tracking, pose.position), glm::normalize(glm::conjugate(tracking.rotation) * pose.rotation)};
}

glm::dvec3 upInWorld(const Tracking& tracking) {
  return tracking.rotation * glm::dvec3(0, 1, 0);
}

glm::dvec3 facingOf(const glm::dquat& rotation, glm::dvec3 up) {
  const auto level = [&](glm::dvec3 v) { return v - glm::dot(v, up) * up; };
  const glm::dvec3 ahead = rotation * glm::dvec3(0, 0, -1), flat = level(ahead);
  if (glm::length(flat) > kVertical) return glm::normalize(flat);
  const glm::dvec3 top = rotation * glm::dvec3(0, 1, 0);
  return glm::normalize(level(glm::dot(ahead, up) < 0 ? top : -top));
}

double headingOf(const glm::dquat& rotation) {
  const glm::dvec3 facing = facingOf(rotation);
  return std::atan2(-facing.x, -facing.z);
}

Tracking levelTracking(glm::dvec3 up, double unitsPerMetre) {
  return {glm::dvec3(0), upright(glm::normalize(up)), unitsPerMetre};
}

Tracking stoodOn(const Tracking& tracking, const Pose& head, glm::dvec3 ground) {
  Tracking stood = tracking;
  stood.origin = ground - tracking.rotation * (tracking.unitsPerMetre * below(head.position));
  return stood;
}

Tracking turned(const Tracking& tracking, const Pose& head, double radians) {
  Tracking turned = tracking;
  turned.rotation = glm::normalize(tracking.rotation * aboutY(radians));
  return pinned(turned, tracking, below(head.position));
}

Tracking turnedTo(const Tracking& tracking, const Pose& head, glm::dvec3 direction) {
  const glm::dvec3 wanted = glm::conjugate(tracking.rotation) * direction;
  const double across = std::hypot(wanted.x, wanted.z);
  if (!(across > 1e-6 * glm::length(wanted))) return tracking;
  return turned(tracking, head, std::atan2(-wanted.x, -wanted.z) - headingOf(head.rotation));
}

Tracking scaled(const Tracking& tracking, const Pose& head, double fixedHeightMetres, double unitsPerMetre) {
  Tracking scaled = tracking;
  scaled.unitsPerMetre = unitsPerMetre;
  return pinned(scaled, tracking, below(head.position, fixedHeightMetres));
}

Tracking recentred(const Tracking& tracking, const Pose& newInOld) {
  Tracking recentred = tracking;
  recentred.rotation = glm::normalize(tracking.rotation * aboutY(headingOf(newInOld.rotation)));
  recentred.origin = inWorld(tracking, below(newInOld.position));
  return recentred;
}

}  // namespace ibr::app
