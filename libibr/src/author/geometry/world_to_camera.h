// SPDX-License-Identifier: Apache-2.0
// Converts poses of COLMAP and OpenCV (world to camera; x right, y down, z forward) to libibr's axes.
#pragma once

#include <glm/gtc/quaternion.hpp>

#include "ibr/camera.h"

namespace ibr {

/// camera = toCamera · world + translation; `toCamera` has unit length.
inline Pose poseFromWorldToCamera(const glm::dquat& toCamera, const glm::dvec3& translation) {
  const glm::dquat toWorld = glm::conjugate(toCamera);
  const glm::dquat halfTurnAboutX(0.0, 1.0, 0.0, 0.0);  // y down, z forward → y up, −z forward
  return {-(toWorld * translation), toWorld * halfTurnAboutX};
}

}  // namespace ibr
