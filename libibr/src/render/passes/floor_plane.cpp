// SPDX-License-Identifier: Apache-2.0
#include "render/passes/floor_plane.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace ibr {

shader::FloorConstants floorConstants(const FramePlan& plan, std::size_t view) noexcept {
  shader::FloorConstants constants{};
  if (!plan.settings.floor) return constants;
  const Floor& plane = *plan.settings.floor;
  const Camera& eye = plan.views[view];
  const Intrinsics& k = eye.intrinsics;
  // Lines run along the world's x axis, or along the y axis if `up` is near the x axis.
  const glm::dvec3 reference = std::abs(plane.up.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 along = glm::normalize(glm::cross(reference, plane.up));
  const glm::dmat3 toPlane = glm::transpose(glm::dmat3(glm::cross(plane.up, along), plane.up, along));
  const glm::dmat3 toRay({1 / k.fx, 0, 0}, {0, -1 / k.fy, 0}, {-k.cx / k.fx, k.cy / k.fy, -1});
  // In double precision, since single precision would lose the fraction.
  const glm::dvec3 position = toPlane * eye.pose.position / plane.spacing;
  constants.toPlane = glm::mat3(toPlane * glm::mat3_cast(eye.pose.rotation) * toRay);
  constants.height = float(position.y - plane.height / plane.spacing);
  constants.origin = {float(position.x - std::floor(position.x)), float(position.z - std::floor(position.z))};
  constants.fadeRadius = float(plane.fadeRadius / plane.spacing);
  return constants;
}

}  // namespace ibr
