// SPDX-License-Identifier: Apache-2.0
#include "ibr/camera.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numbers>

#include "base/check.h"

namespace ibr {
namespace {

constexpr double kPi = std::numbers::pi;

bool finite(glm::dvec2 v) {
  return std::isfinite(v.x) && std::isfinite(v.y);
}
bool finite(glm::dvec3 v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// Scales first, so that squares of neither long nor short vectors leave the range of double.
glm::dvec3 unit(glm::dvec3 v) {
  return glm::normalize(v / std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}));
}

glm::dvec3 direction(const Intrinsics& k, glm::dvec2 pixel) {
  if (k.model == CameraModel::equirectangular) {
    const double longitude = (pixel.x / k.width - 0.5) * 2.0 * kPi;
    const double latitude = (0.5 - pixel.y / k.height) * kPi;
    return {std::sin(longitude) * std::cos(latitude), std::sin(latitude), -std::cos(longitude) * std::cos(latitude)};
  }
  constexpr double kSideways = 1e300;  // replaces a quotient beyond the range of double
  return unit({std::clamp((pixel.x - k.cx) / k.fx, -kSideways, kSideways),
               std::clamp((k.cy - pixel.y) / k.fy, -kSideways, kSideways), -1.0});
}

}  // namespace

Intrinsics pinholeFromFov(int width, int height, double fovYRadians) {
  const double tangent = std::tan(0.5 * fovYRadians);
  const double focal = tangent > 0.0 ? 0.5 * height / tangent : 0.0;
  check(width >= 1 && height >= 1 && fovYRadians > 0.0 && fovYRadians < kPi && focal > 0.0 && std::isfinite(focal),
        ErrorCode::invalidInput, "a pinhole camera of {}x{} px cannot have a field of view of {} radians", width,
        height, fovYRadians);
  return {CameraModel::pinhole, width, height, focal, focal, 0.5 * width, 0.5 * height};
}

Intrinsics pinholeFromTangents(int width, int height, double left, double right, double up, double down) {
  const double steepest = std::tan(89.95 / 180.0 * kPi);
  const bool inFront = std::abs(left) < steepest && std::abs(right) < steepest && std::abs(up) < steepest &&
                       std::abs(down) < steepest;  // false for NaN
  const double fx = width / (right - left), fy = height / (up - down);
  check(width >= 1 && height >= 1 && inFront && left < right && down < up && std::isfinite(fx) && std::isfinite(fy),
        ErrorCode::invalidInput,
        "a pinhole camera of {}x{} px cannot have the tangents left {}, right {}, up {}, down {}", width, height, left,
        right, up, down);
  return {CameraModel::pinhole, width, height, fx, fy, -left * fx, up * fy};
}

glm::dvec3 unproject(const Intrinsics& k, glm::dvec2 pixel) {
  const bool usable =
      k.model == CameraModel::equirectangular ? k.width > 0 && k.height > 0 : k.fx != 0.0 && k.fy != 0.0;
  const glm::dvec3 ray = usable ? direction(k, pixel) : glm::dvec3(0.0);
  check(usable && finite(pixel) && finite(ray), ErrorCode::invalidInput,
        "pixel ({}, {}) of a camera with f ({}, {}) and c ({}, {}) has no direction", pixel.x, pixel.y, k.fx, k.fy,
        k.cx, k.cy);
  return ray;
}

std::optional<glm::dvec2> project(const Intrinsics& k, glm::dvec3 d) {
  if (!finite(d) || d == glm::dvec3(0.0)) return std::nullopt;
  if (k.model == CameraModel::equirectangular) {
    // atan2 instead of asin: exact near the poles. Scaled first, since hypot may overflow.
    d = unit(d);
    return glm::dvec2((std::atan2(d.x, -d.z) / (2.0 * kPi) + 0.5) * k.width,
                      (0.5 - std::atan2(d.y, std::hypot(d.x, d.z)) / kPi) * k.height);
  }
  if (!(d.z < 0.0)) return std::nullopt;
  const glm::dvec2 pixel(k.cx - k.fx * (d.x / d.z), k.cy + k.fy * (d.y / d.z));
  return finite(pixel) ? std::optional(pixel) : std::nullopt;
}

glm::dvec3 viewAxis(const Pose& pose) {
  return pose.rotation * glm::dvec3(0.0, 0.0, -1.0);
}

glm::dmat4 worldFromCamera(const Pose& pose) {
  glm::dmat4 m = glm::mat4_cast(pose.rotation);
  m[3] = glm::dvec4(pose.position, 1.0);
  return m;
}

glm::dmat4 cameraFromWorld(const Pose& pose) {
  const glm::dquat back = glm::conjugate(pose.rotation);
  return worldFromCamera({-(back * pose.position), back});
}

glm::dmat4 clipFromCamera(const Intrinsics& k, double nearPlane, double farPlane, bool reversed) {
  check(nearPlane > 0.0 && nearPlane < farPlane && std::isfinite(nearPlane), ErrorCode::invalidInput,
        "a projection cannot have its near plane at {} and its far plane at {}", nearPlane, farPlane);
  // depth = offset + slope / distance; an infinite far plane is the limit
  double offset = std::isinf(farPlane) ? 1.0 : farPlane / (farPlane - nearPlane);
  double slope = -nearPlane * offset;
  if (reversed) {
    offset = 1.0 - offset;
    slope = -slope;
  }
  const glm::dvec2 scale(2.0 * k.fx / k.width, 2.0 * k.fy / k.height);
  const glm::dvec2 shift(1.0 - 2.0 * k.cx / k.width, 1.0 - 2.0 * k.cy / k.height);
  check(k.model == CameraModel::pinhole && k.fx > 0.0 && k.fy > 0.0 && std::min(k.width, k.height) >= 1 &&
            finite(scale) && finite(shift) && std::isfinite(offset) && std::isfinite(slope),
        ErrorCode::invalidInput, "a camera of {}x{} px with f ({}, {}) and c ({}, {}) has no projection matrix",
        k.width, k.height, k.fx, k.fy, k.cx, k.cy);
  glm::dmat4 m(0.0);
  m[0].x = scale.x;
  m[1].y = -scale.y;
  m[2] = {shift, -offset, -1.0};
  m[3].z = slope;
  return m;
}

double angleBetween(const glm::dquat& a, const glm::dquat& b) {
  const glm::dquat turn = glm::conjugate(a) * b;
  return 2 * std::atan2(glm::length(glm::dvec3(turn.x, turn.y, turn.z)), std::abs(turn.w));
}

Intrinsics resized(const Intrinsics& k, int width, int height) {
  check(std::min({k.width, k.height, width, height}) >= 1, ErrorCode::invalidInput,
        "an image of {}x{} px cannot be scaled to {}x{}", k.width, k.height, width, height);
  const double sx = double(width) / k.width, sy = double(height) / k.height;
  return {k.model, width, height, k.fx * sx, k.fy * sy, k.cx * sx, k.cy * sy};
}

}  // namespace ibr
