// SPDX-License-Identifier: Apache-2.0
#include "ibr/camera.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace ibr {
namespace {
constexpr double kPi = std::numbers::pi;
}

Intrinsics pinholeFromFov(int width, int height, double fovYRadians) {
  const double focal = 0.5 * height / std::tan(0.5 * fovYRadians);
  return {CameraModel::pinhole, width, height, focal, focal, 0.5 * width, 0.5 * height};
}

glm::dvec3 unproject(const Intrinsics& k, glm::dvec2 pixel) {
  if (k.model == CameraModel::equirectangular) {
    const double longitude = (pixel.x / k.width - 0.5) * 2.0 * kPi;
    const double latitude = (0.5 - pixel.y / k.height) * kPi;
    return {std::sin(longitude) * std::cos(latitude), std::sin(latitude), -std::cos(longitude) * std::cos(latitude)};
  }
  return glm::normalize(glm::dvec3((pixel.x - k.cx) / k.fx, (k.cy - pixel.y) / k.fy, -1.0));
}

std::optional<glm::dvec2> project(const Intrinsics& k, glm::dvec3 d) {
  if (k.model == CameraModel::equirectangular) {
    const double horizontal = std::hypot(d.x, d.z);
    if (!std::isfinite(horizontal + d.y) || (horizontal == 0.0 && d.y == 0.0)) return std::nullopt;
    // atan2 rather than asin: exact near the poles and for any length of d.
    return glm::dvec2((std::atan2(d.x, -d.z) / (2.0 * kPi) + 0.5) * k.width,
                      (0.5 - std::atan2(d.y, horizontal) / kPi) * k.height);
  }
  const glm::dvec2 pixel(k.cx - k.fx * d.x / d.z, k.cy + k.fy * d.y / d.z);
  if (!(d.z < 0.0) || !std::isfinite(pixel.x + pixel.y)) return std::nullopt;
  return pixel;
}

glm::dvec3 viewAxis(const Pose& pose) { return pose.rotation * glm::dvec3(0.0, 0.0, -1.0); }

Intrinsics resized(const Intrinsics& k, int width, int height) {
  const double sx = double(width) / k.width, sy = double(height) / k.height;
  return {k.model, width, height, k.fx * sx, k.fy * sy, k.cx * sx, k.cy * sy};
}

}  // namespace ibr
