// SPDX-License-Identifier: Apache-2.0
#include "author/geometry/mean_frame.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>

namespace ibr {

Camera meanFrame(std::span<const Camera> members) {
  glm::dvec3 offset(0.0), axis(0.0), up(0.0);
  double focal = 0, left = 0, right = 0, above = 0, below = 0;
  const double share = 1.0 / double(members.size());
  for (const Camera& member : members) {
    const Intrinsics& k = member.intrinsics;
    offset += share * (member.pose.position - members[0].pose.position);
    axis += viewAxis(member.pose);
    up += member.pose.rotation * glm::dvec3(0, 1, 0);
    focal += share * std::sqrt(k.fx * k.fy);
    left += share * k.cx / k.fx;
    right += share * (k.width - k.cx) / k.fx;
    above += share * k.cy / k.fy;
    below += share * (k.height - k.cy) / k.fy;
  }
  axis = glm::normalize(axis);
  auto across = [&](glm::dvec3 v) { return v - glm::dot(v, axis) * axis; };
  up = across(up);
  // Members rotated against each other about the axis have no mean up vector: the first member decides.
  if (glm::length(up) < 0.3 * double(members.size())) up = across(members[0].pose.rotation * glm::dvec3(0, 1, 0));
  up = glm::normalize(up);
  const glm::dmat3 rotation(glm::cross(axis, up), up, -axis);

  Camera frame;
  Intrinsics& k = frame.intrinsics;
  k.width = std::max(1, int(std::lround(focal * (left + right))));
  k.height = std::max(1, int(std::lround(focal * (above + below))));
  k.fx = k.fy = focal;
  k.cx = focal * left;
  k.cy = focal * above;
  frame.pose = {members[0].pose.position + offset, glm::normalize(glm::quat_cast(rotation))};
  return frame;
}

FrameToMember frameToMember(const Camera& frame, const Camera& member) {
  const Intrinsics &f = frame.intrinsics, &m = member.intrinsics;
  // glm's matrices are column-major.
  const glm::dmat3 toRay(glm::dvec3(1 / f.fx, 0, 0), glm::dvec3(0, -1 / f.fy, 0),
                         glm::dvec3(-f.cx / f.fx, f.cy / f.fy, -1));  // pixel → camera axes, depth 1
  const glm::dmat3 toPixel(glm::dvec3(m.fx, 0, 0), glm::dvec3(0, -m.fy, 0), glm::dvec3(-m.cx, -m.cy, -1));
  const glm::dmat3 turn = glm::mat3_cast(glm::inverse(member.pose.rotation) * frame.pose.rotation);
  const glm::dvec3 shift = glm::inverse(member.pose.rotation) * (frame.pose.position - member.pose.position);
  return {toPixel * turn * toRay, toPixel * shift};
}

double inverseDepth(const Camera& frame, glm::dvec3 point) {
  const double depth = glm::dot(point - frame.pose.position, viewAxis(frame.pose));
  return 1.0 / depth;
}

}  // namespace ibr
