// SPDX-License-Identifier: Apache-2.0
// Maps a view's pixel and inverse depth to a photograph's pixel of the same point, ray by ray.
#pragma once

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "ibr/camera.h"

namespace ibr {

/// Both are pinholes. A pixel's point at inverse depth w (along the view's axis, 0 = at infinity) lies in direction
/// ray(pixel) from the view. From the photograph: ray(pixel) + w·shift(). Both are in the photograph's axes.
class Reprojection {
 public:
  Reprojection(const Camera& view, const Camera& photograph)
      : view_(view.intrinsics), photograph_(photograph.intrinsics) {
    const glm::dquat toPhotograph = glm::conjugate(photograph.pose.rotation);
    turn_ = glm::mat3_cast(toPhotograph * view.pose.rotation);
    shift_ = toPhotograph * (view.pose.position - photograph.pose.position);
  }

  glm::dvec3 ray(glm::dvec2 pixel) const {
    return turn_ * glm::dvec3((pixel.x - view_.cx) / view_.fx, (view_.cy - pixel.y) / view_.fy, -1.0);
  }
  const glm::dvec3& shift() const { return shift_; }

  /// Pixel of a direction in the photograph's axes. Precondition: direction.z < 0, in front of the photograph.
  glm::dvec2 pixel(const glm::dvec3& direction) const {
    return {photograph_.cx - photograph_.fx * direction.x / direction.z,
            photograph_.cy + photograph_.fy * direction.y / direction.z};
  }
  bool inside(glm::dvec2 pixel) const {
    return pixel.x >= 0 && pixel.y >= 0 && pixel.x <= photograph_.width && pixel.y <= photograph_.height;
  }

 private:
  Intrinsics view_, photograph_;
  glm::dmat3 turn_;
  glm::dvec3 shift_;
};

}  // namespace ibr
