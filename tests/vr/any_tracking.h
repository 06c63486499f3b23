// SPDX-License-Identifier: Apache-2.0
// Random tracking spaces and heads, for relations that hold for all of them.
#pragma once

#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/quaternion.hpp>
#include <random>

#include "vr/walk/tracking.h"

namespace ibr::test {

class AnyTracking {
 public:
  explicit AnyTracking(unsigned seed) : random_(seed) {}

  double between(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }

  glm::dvec3 unit() {
    for (;;) {
      const glm::dvec3 v(between(-1, 1), between(-1, 1), between(-1, 1));
      if (const double length = glm::length(v); length > 0.1 && length < 1) return v / length;
    }
  }

  /// A tracking space at a distance of `far` from the origin, with a scale from 10^−powers to 10^powers.
  app::Tracking tracking(double far, double powers) {
    app::Tracking tracking = app::levelTracking(unit(), std::pow(10, between(-powers, powers)));
    tracking.origin = far * unit();
    return app::turned(tracking, {}, between(-3, 3));
  }

  /// A person's head, looking up to 80° up or down and tilted by up to 40°.
  Pose head() {
    const glm::dquat turn = glm::angleAxis(between(-3, 3), glm::dvec3(0, 1, 0)) *
                            glm::angleAxis(between(-1.4, 1.4), glm::dvec3(1, 0, 0)) *
                            glm::angleAxis(between(-0.7, 0.7), glm::dvec3(0, 0, 1));
    return {{between(-2, 2), between(1, 2), between(-2, 2)}, turn};
  }

 private:
  std::mt19937 random_;
};

/// Rounding error of a point in the person's room, world units.
inline double worldRounding(const app::Tracking& tracking) {
  return 1e-14 * (glm::length(tracking.origin) + 10 * tracking.unitsPerMetre);
}

inline double angleBetween(glm::dvec3 a, glm::dvec3 b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

}  // namespace ibr::test
