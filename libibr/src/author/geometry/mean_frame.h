// SPDX-License-Identifier: Apache-2.0
// The mean camera of a cell, in whose image all matches are sampled. All members have the same influence. To first
// order, the camera's centre is the mean position at which [T] §2.4.1 triangulates.
#pragma once

#include <glm/mat3x3.hpp>
#include <optional>
#include <span>

#include "ibr/camera.h"

namespace ibr {

/// Mean centre, direction, focal length and field of view; upright as the members are on average. Precondition: at
/// least one pinhole member; axes within 90 degrees of their mean.
Camera meanFrame(std::span<const Camera> members);

/// Maps a pixel and an inverse depth of the frame (along its axis, 0 = infinity) to a member: homogeneous pixel = a·(x,
/// y, 1) + inverseDepth·b, whose third component is positive in front of the member.
struct FrameToMember {
  glm::dmat3 a;
  glm::dvec3 b;

  glm::dvec3 homogeneous(glm::dvec2 pixel, double inverseDepth) const {
    return a * glm::dvec3(pixel, 1.0) + inverseDepth * b;
  }
  std::optional<glm::dvec2> operator()(glm::dvec2 pixel, double inverseDepth) const {
    const glm::dvec3 h = homogeneous(pixel, inverseDepth);
    if (!(h.z > 0)) return std::nullopt;
    return glm::dvec2(h.x / h.z, h.y / h.z);
  }
};
FrameToMember frameToMember(const Camera& frame, const Camera& member);

/// Inverse depth of a world point along the frame's axis; not positive behind the frame.
double inverseDepth(const Camera& frame, glm::dvec3 point);

}  // namespace ibr
