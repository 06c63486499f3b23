// SPDX-License-Identifier: Apache-2.0
// Camera models and poses. Axes and pixel convention: ibr/conventions.h.
#pragma once

#include <cstdint>
#include <glm/mat4x4.hpp>
#include <limits>
#include <optional>

#include "ibr/conventions.h"
#include "ibr/export.h"

namespace ibr {

/// Projection of an image.
enum class CameraModel : std::uint8_t {
  pinhole,         // perspective projection without distortion
  equirectangular  // panorama of all directions (ibr/conventions.h)
};

/// Projection and size of an image.
struct Intrinsics {
  CameraModel model = CameraModel::pinhole;  // projection
  int width = 0;                             // px
  int height = 0;                            // px
  // In px, 0 for equirectangular. fx, fy: focal lengths; cx, cy: principal point
  double fx = 0, fy = 0, cx = 0, cy = 0;

  bool operator==(const Intrinsics&) const = default;
};

/// Maps camera coordinates to world coordinates: world = position + rotation · camera.
struct Pose {
  glm::dvec3 position{0.0};                 // camera centre, world
  glm::dquat rotation{1.0, 0.0, 0.0, 0.0};  // unit; maps camera axes to world axes
  bool operator==(const Pose&) const = default;
};

/// A camera in the world.
struct Camera {
  Intrinsics intrinsics;  // projection and image size
  Pose pose;              // position and orientation
  bool operator==(const Camera&) const = default;
};

/// Returns a pinhole with square pixels and a centred principal point; fovYRadians is the vertical field of view.
/// Throws Error{invalidInput} unless width, height >= 1 and 0 < fovYRadians < π.
IBR_API Intrinsics pinholeFromFov(int width, int height, double fovYRadians);

/// Returns a pinhole from the tangents of its four edges, as headsets have them (OpenXR's XrFovf holds the angles): x
/// right, y up on the plane z = −1. Left and down are negative where the viewing axis lies inside the image. Throws
/// Error{invalidInput} unless width, height >= 1, left < right, down < up, and all edges are < 89.95° off the axis.
IBR_API Intrinsics pinholeFromTangents(int width, int height, double left, double right, double up, double down);

/// Returns the viewing direction of a pixel: unit, camera axes. The pixel may lie outside the image. Throws
/// Error{invalidInput} where the pixel is not finite, or the intrinsics give no finite direction.
IBR_API glm::dvec3 unproject(const Intrinsics& intrinsics, glm::dvec2 pixel);

/// Returns the pixel at which a direction of any length (camera axes) is seen; the pixel may lie outside the image.
/// nullopt for directions that a pinhole does not face (z >= 0), zero or non-finite directions, and non-finite pixels.
IBR_API std::optional<glm::dvec2> project(const Intrinsics& intrinsics, glm::dvec3 direction);

/// Returns the camera's viewing axis in world axes; unit if the rotation is.
IBR_API glm::dvec3 viewAxis(const Pose& pose);

/// Returns the matrix from camera to world coordinates: the model matrix of an object in camera axes.
IBR_API glm::dmat4 worldFromCamera(const Pose& pose);

/// Returns the matrix from world to camera coordinates: the view matrix.
IBR_API glm::dmat4 cameraFromWorld(const Pose& pose);

/// Returns the projection matrix of a pinhole, from camera axes to Vulkan's clip space. Pixels are those of project();
/// depth is 0 at nearPlane and 1 at farPlane, reversed 1 and 0, as in a DepthTarget (ibr/target.h). Throws
/// Error{invalidInput} unless 0 < nearPlane < farPlane, and for intrinsics without a finite matrix.
IBR_API glm::dmat4 clipFromCamera(const Intrinsics& pinhole, double nearPlane,
                                  double farPlane = std::numeric_limits<double>::infinity(), bool reversed = false);

/// Returns the angle between two rotations, radians, 0 to π.
IBR_API double angleBetween(const glm::dquat& a, const glm::dquat& b);

/// Returns the intrinsics for the image scaled to width × height, in the same pixel convention. Throws
/// Error{invalidInput} unless all sizes are >= 1.
IBR_API Intrinsics resized(const Intrinsics& intrinsics, int width, int height);

}  // namespace ibr
