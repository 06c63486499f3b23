// SPDX-License-Identifier: Apache-2.0
// Pinhole cameras as matrices for positions relative to a model's middle. Differences are computed in double precision,
// so a model far from the world's origin loses no accuracy.
#pragma once

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>

#include "ibr/camera.h"

namespace ibr {

/// With p = (position − middle, 1): the depth along the viewing axis is dot(depthOf, p), the pixel is (dot(column, p),
/// dot(row, p)) / depth.
struct HtmProjection {
  glm::dvec4 column, row, depthOf;
};

inline HtmProjection htmProjection(const Camera& camera, const glm::dvec3& middle) {
  const glm::dmat3 axes = glm::mat3_cast(glm::normalize(camera.pose.rotation));
  const glm::dvec3 from = middle - camera.pose.position;
  const auto along = [&](const glm::dvec3& axis) { return glm::dvec4(axis, glm::dot(axis, from)); };
  const glm::dvec4 right = along(axes[0]), up = along(axes[1]), ahead = along(-axes[2]);
  const Intrinsics& k = camera.intrinsics;
  return {k.fx * right + k.cx * ahead, -k.fy * up + k.cy * ahead, ahead};
}

/// Clip space: the image covers −1 to 1, depth is 1 − nearDistance / depth, which is linear in screen space.
inline glm::mat4 htmClip(const HtmProjection& projection, const Intrinsics& k, double nearDistance) {
  const glm::dvec4 rows[]{2.0 / k.width * projection.column - projection.depthOf,
                          2.0 / k.height * projection.row - projection.depthOf,
                          projection.depthOf - glm::dvec4(0, 0, 0, nearDistance), projection.depthOf};
  glm::mat4 clip;
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c) clip[c][r] = float(rows[r][c]);
  return clip;
}

}  // namespace ibr
