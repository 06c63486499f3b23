// SPDX-License-Identifier: Apache-2.0
// Bundle adjustment (Triggs et al. 2000): poses, intrinsics and points that fit best where points are seen.
//
//   minimised   Σ ρ(|seen − projected|²) + Σ (change / deviation)² of poses and intrinsics since the start
//   ρ           soft L1: squares up to `softPx`, distances beyond it; or Cauchy's: hardly more, however far beyond
//   pose        a rotation about the camera's axes and a shift in the world, both since the start
//   intrinsics  a factor of both focal lengths and a shift of the principal point; cameras may share them
//   point       a direction and an inverse distance from the middle of those that see it, so that infinity is a place
//               like others
//
// By Ceres: Levenberg–Marquardt, points eliminated (Schur complement), on one thread: the same input, the same bits.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

#include "ibr/camera.h"

namespace ibr {

struct BundleCamera {
  Camera camera;                 // a pinhole
  std::uint32_t intrinsics = 0;  // cameras with the same number change theirs alike
  bool fixed = false;            // its pose stays
  bool keepIntrinsics = false;   // they stay, of all that share them
};

struct BundleObservation {
  std::uint32_t camera;
  glm::dvec2 pixel;
};

struct BundlePoint {
  glm::dvec4 position;  // world, homogeneous: (x, y, z)/w, w >= 0; in direction (x, y, z) where w = 0
  std::vector<BundleObservation> seen;
};

/// Deviations are one standard deviation, against reprojections of 1 px. 0: stays as it is.
struct BundleOptions {
  double softPx = 0.5;
  double cauchyPx = 0;    // > 0: Cauchy's loss of this scale, for points of which many are wrong
  double radians = 0.01;  // of a camera's rotation
  double shift = 0.01;    // of its position, world units
  double focal = 0;       // of the focal lengths' logarithm
  double centrePx = 0;    // of the principal point
  int rounds = 50;
  double enoughDecrease = 1e-6;  // of the sum, to go on
};

struct Bundle {
  std::vector<Camera> cameras;
  std::vector<glm::dvec4> points;  // of unit length where they were seen
};

/// Points behind a camera that sees them at the start, and those that fewer than two cameras see, count nothing and
/// stay. Precondition: deviations of poses are positive, observations name cameras that are there.
Bundle adjustBundle(std::span<const BundleCamera> cameras, std::span<const BundlePoint> points,
                    const BundleOptions& options = {});

/// Where it sees a homogeneous point of the world; nullopt where that is behind it.
std::optional<glm::dvec2> seenAt(const Camera& camera, const glm::dvec4& point);

}  // namespace ibr
