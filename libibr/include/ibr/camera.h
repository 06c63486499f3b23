// SPDX-License-Identifier: Apache-2.0
// Camera models and poses. Frames and pixel convention: conventions.h.
#pragma once

#include <cstdint>
#include <optional>

#include "ibr/conventions.h"

namespace ibr {

enum class CameraModel : std::uint8_t { pinhole, equirectangular };

struct Intrinsics {
  CameraModel model = CameraModel::pinhole;
  int width = 0;                          // px
  int height = 0;                         // px
  double fx = 0, fy = 0, cx = 0, cy = 0;  // px; pinhole only, 0 for equirectangular

  bool operator==(const Intrinsics&) const = default;
};

/// Maps camera axes to world: world = position + rotation · camera.
struct Pose {
  glm::dvec3 position{0.0};                 // the camera's centre in the world
  glm::dquat rotation{1.0, 0.0, 0.0, 0.0};  // unit
};

struct Camera {
  Intrinsics intrinsics;
  Pose pose;
};

/// A pinhole with square pixels and a centred principal point. Throws Error{invalidInput} unless width, height >= 1 and
/// 0 < fovYRadians < π.
Intrinsics pinholeFromFov(int width, int height, double fovYRadians);

/// A pinhole from the tangents of its four edges, as headsets have them (OpenXR's XrFovf holds the angles): x right and
/// y up on the plane z = −1, so that left and down are negative where the axis lies inside of the picture. Throws
/// Error{invalidInput} unless width, height >= 1, left < right, down < up, and no edge is 89.95° or more off the axis.
Intrinsics pinholeFromTangents(int width, int height, double left, double right, double up, double down);

/// Unit direction, in camera axes, in which `pixel` looks. Any finite pixel is allowed, also outside the picture.
/// Throws Error{invalidInput} where pixel or intrinsics are not finite.
glm::dvec3 unproject(const Intrinsics& intrinsics, glm::dvec2 pixel);

/// Pixel at which a direction of any length (camera axes) is seen, also outside the picture; nullopt where there is
/// none: behind a pinhole, or a zero or non-finite direction.
std::optional<glm::dvec2> project(const Intrinsics& intrinsics, glm::dvec3 direction);

/// The camera's viewing axis in the world (unit where the rotation is).
glm::dvec3 viewAxis(const Pose& pose);

/// The same camera for the picture scaled to width × height (pixel centres convention kept). Throws Error{invalidInput}
/// unless all sizes are >= 1.
Intrinsics resized(const Intrinsics& intrinsics, int width, int height);

}  // namespace ibr
