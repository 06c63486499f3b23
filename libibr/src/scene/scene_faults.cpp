// SPDX-License-Identifier: Apache-2.0
#include "scene/scene_faults.h"

namespace ibr {

void checkCamera(const Camera& camera, const std::string& at, Faults& faults) {
  const Intrinsics& k = camera.intrinsics;
  constexpr int kMaxSide = 1 << 16;
  if (k.width < 1 || k.height < 1 || k.width > kMaxSide || k.height > kMaxSide)
    faults.add(at + ".intrinsics", "size {}x{} is not within 1 to {}", k.width, k.height, kMaxSide);
  if (k.model == CameraModel::pinhole) {
    if (!(k.fx > 0) || !(k.fy > 0) || !std::isfinite(k.fx) || !std::isfinite(k.fy))
      faults.add(at + ".intrinsics", "focal lengths {} and {} are not positive", k.fx, k.fy);
    if (!std::isfinite(k.cx) || !std::isfinite(k.cy))
      faults.add(at + ".intrinsics", "principal point ({}, {}) is not finite", k.cx, k.cy);
  }
  if (!finite(camera.pose.position))
    faults.add(at + ".pose.position", "is not finite");
  else if (!withinWorld(camera.pose.position))
    faults.add(at + ".pose.position", "is further from the origin than {} world units", kWorldRadius);
  const glm::dquat& q = camera.pose.rotation;
  const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  if (!(std::abs(length - 1.0) <= 1e-3)) faults.add(at + ".pose.rotation", "has length {}, not 1", length);
}

}  // namespace ibr
