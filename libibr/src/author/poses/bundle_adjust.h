// SPDX-License-Identifier: Apache-2.0
// Bundle adjustment (Triggs et al. 2000): fits poses, intrinsics and points to the points' observations.
//
//   minimised   Σ ρ(|seen − projected|²) + Σ (change / deviation)² of poses and intrinsics since the start
//   ρ           soft L1: squares up to `softPx`, distances beyond; or Cauchy's, which hardly grows for outliers
//   pose        a rotation about the camera's axes and a translation in the world, both since the start
//   intrinsics  a factor of both focal lengths and a shift of the principal point; cameras may share them
//   point       a direction and an inverse distance from the mean of the cameras that see it: infinity needs no
//               special case
//
// Solved by Ceres: Levenberg–Marquardt, points eliminated (Schur complement), on one thread: bit-identical results.
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
  std::uint32_t intrinsics = 0;  // cameras with the same number share their intrinsics
  bool fixed = false;            // the pose is kept
  bool keepIntrinsics = false;   // the intrinsics are kept, for all cameras that share them
};

struct BundleObservation {
  std::uint32_t camera;
  glm::dvec2 pixel;
};

struct BundlePoint {
  glm::dvec4 position;  // world, homogeneous: (x, y, z)/w, w >= 0; at infinity in direction (x, y, z) if w = 0
  std::vector<BundleObservation> seen;
};

/// Deviations are standard deviations, relative to reprojection errors of 1 px. Intrinsics need both of theirs > 0.
struct BundleOptions {
  double softPx = 0.5;
  double cauchyPx = 0;    // > 0: Cauchy's loss of this scale, for points with many outliers
  double radians = 0.01;  // of a camera's rotation
  double shift = 0.01;    // of a camera's position, world units
  double focal = 0;       // of the logarithm of the focal lengths; 0: kept
  double centrePx = 0;    // of the principal point; 0: kept
  int rounds = 50;
  double minDecrease = 1e-6;  // minimum relative decrease of the sum for another iteration
};

struct Bundle {
  std::vector<Camera> cameras;
  std::vector<glm::dvec4> points;  // of unit length if adjusted
};

/// Points that fewer than two cameras see, or that lie behind one of them at the start, do not count and are kept.
/// Precondition: deviations of poses are positive, observations name existing cameras.
Bundle adjustBundle(std::span<const BundleCamera> cameras, std::span<const BundlePoint> points,
                    const BundleOptions& options = {});

/// Projects a homogeneous world point; nullopt if the point is behind the camera.
std::optional<glm::dvec2> seenAt(const Camera& camera, const glm::dvec4& point);

}  // namespace ibr
