// SPDX-License-Identifier: Apache-2.0
// Cameras with pose errors of known size. The numbers are the same with every standard library.
#pragma once

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <random>
#include <vector>

#include "ibr/camera.h"

namespace ibr::test {

class PoseNoise {
 public:
  explicit PoseNoise(unsigned seed) : engine_(seed) {}

  double uniform(double low, double high) { return low + (high - low) * double(engine_()) / 4294967295.0; }
  /// Returns a vector with components of at most `size`, absolute.
  glm::dvec3 vector(double size) {
    const double x = uniform(-size, size), y = uniform(-size, size);
    return {x, y, uniform(-size, size)};
  }
  /// Turns cameras by at most `radians` about each axis and shifts them by at most `shift` along each axis.
  std::vector<Camera> on(std::vector<Camera> cameras, double radians, double shift) {
    for (Camera& camera : cameras) {
      camera.pose.rotation = glm::normalize(camera.pose.rotation * glm::dquat(1, vector(radians) / 2.0));
      camera.pose.position += vector(shift);
    }
    return cameras;
  }

 private:
  std::mt19937 engine_;
};

}  // namespace ibr::test
