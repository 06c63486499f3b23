// SPDX-License-Identifier: Apache-2.0
#include "author/geometry/epipolar_direction.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

namespace ibr {

// In camera axes, ρ × the point keeps the direction of the pixel's ray. As ρ = 1/distance from the centre grows, ρ ×
// the point changes by the vector from the camera to the centre. The projection's quotient rule gives the rest.
glm::dvec2 epipolarDirection(const Camera& camera, glm::dvec3 centre, glm::dvec2 pixel) {
  const Intrinsics& k = camera.intrinsics;
  const glm::dvec3 ray((pixel.x - k.cx) / k.fx, (k.cy - pixel.y) / k.fy, -1.0);
  const glm::dvec3 towards = glm::conjugate(camera.pose.rotation) * (centre - camera.pose.position);
  const double length = glm::length(towards);
  if (!(length > 0)) return glm::dvec2(0);
  const glm::dvec3 way = towards / length;
  const glm::dvec2 slope(k.fx * (way.x + ray.x * way.z), -k.fy * (way.y + ray.y * way.z));
  const double steepness = glm::length(slope);
  constexpr double kAtEpipole = 1e-9;  // relative to the focal length
  return steepness > kAtEpipole * k.fx ? slope / steepness : glm::dvec2(0);
}

}  // namespace ibr
