// SPDX-License-Identifier: Apache-2.0
#include "author/panorama/panorama_faces.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numbers>

#include "base/check.h"

namespace ibr {
namespace {
constexpr double kPi = std::numbers::pi;

void checkFace(double fovRadians) {
  check(fovRadians > 0 && fovRadians < kPi, ErrorCode::invalidInput,
        "a face's field of view of {} radians is not between 0 and π", fovRadians);
}
}  // namespace

std::array<glm::dquat, 6> cubeRotations() {
  const glm::dvec3 x(1, 0, 0), y(0, 1, 0);
  return {glm::dquat(1, 0, 0, 0),     glm::angleAxis(-kPi / 2, y), glm::angleAxis(kPi, y),
          glm::angleAxis(kPi / 2, y), glm::angleAxis(kPi / 2, x),  glm::angleAxis(-kPi / 2, x)};
}

std::vector<PanoramaFace> cubeFaces() {
  constexpr std::array kNames{"front", "right", "back", "left", "up", "down"};
  std::vector<PanoramaFace> faces;
  for (const glm::dquat turn : cubeRotations()) faces.push_back({kNames[faces.size()], turn});
  return faces;
}

std::vector<PanoramaFace> horizonFaces(int count) {
  check(count >= 1 && count <= 360, ErrorCode::invalidInput, "{} views around the horizon, must be 1 to 360", count);
  std::vector<PanoramaFace> faces;
  for (int i = 0; i < count; ++i)
    faces.push_back(
        {fmt::format("view{:0{}}", i, count > 100 ? 3 : 2), glm::angleAxis(-2 * kPi * i / count, glm::dvec3(0, 1, 0))});
  return faces;
}

Intrinsics faceIntrinsics(int size, double fovRadians) {
  checkFace(fovRadians);
  const double focal = 0.5 * size / std::tan(0.5 * fovRadians);
  return {CameraModel::pinhole, size, size, focal, focal, 0.5 * size, 0.5 * size};
}

int faceSize(int panoramaWidth, double fovRadians) {
  checkFace(fovRadians);
  return int(std::clamp(std::round(panoramaWidth / kPi * std::tan(0.5 * fovRadians)), 1.0, 1e9));
}

double solidAngle(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) {
  return 2 * std::atan2(glm::dot(a, glm::cross(b, c)), 1 + glm::dot(a, b) + glm::dot(b, c) + glm::dot(c, a));
}

}  // namespace ibr
