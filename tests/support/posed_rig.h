// SPDX-License-Identifier: Apache-2.0
// Simulated camera rigs with exact tracks.
#pragma once

#include <fmt/format.h>
#include <cstddef>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <random>
#include <vector>

#include "ibr/author/poses.h"

namespace ibr::test {

/// Returns a camera at `position` that looks along `direction`, with `up` up.
inline Camera lookingAlong(glm::dvec3 position, glm::dvec3 direction, int width = 200, int height = 150,
                           double fovY = 0.9, glm::dvec3 up = {0, 0, 1}) {
  const glm::dvec3 back = -glm::normalize(direction);
  const glm::dvec3 right = glm::normalize(glm::cross(up, back));
  const glm::dmat3 axes(right, glm::cross(back, right), back);
  return {pinholeFromFov(width, height, fovY), {position, glm::normalize(glm::quat_cast(axes))}};
}

/// Returns a model of the cameras (named "000", "001", …, or as given) that see the points; observations are exact.
inline PosedModel modelOf(const std::vector<Camera>& cameras, const std::vector<glm::dvec3>& points) {
  PosedModel model;
  for (std::size_t i = 0; i < cameras.size(); ++i) model.images.push_back({fmt::format("{:03}.png", i), cameras[i]});
  for (const glm::dvec3& point : points) {
    Track track{point, {}};
    for (std::size_t i = 0; i < cameras.size(); ++i) {
      const Intrinsics& k = cameras[i].intrinsics;
      const auto pixel = project(k, glm::inverse(cameras[i].pose.rotation) * (point - cameras[i].pose.position));
      if (pixel && pixel->x >= 0 && pixel->y >= 0 && pixel->x <= k.width && pixel->y <= k.height)
        track.observations.push_back({std::uint32_t(i), *pixel});
    }
    if (!track.observations.empty()) model.tracks.push_back(std::move(track));
  }
  return model;
}

/// Returns points on a sphere around `centre`, uniformly random.
inline std::vector<glm::dvec3> pointsAround(glm::dvec3 centre, double radius, std::size_t count) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  std::vector<glm::dvec3> points;
  while (points.size() < count) {
    const glm::dvec3 v(normal(random), normal(random), normal(random));
    if (glm::length(v) > 1e-3) points.push_back(centre + radius * glm::normalize(v));
  }
  return points;
}

}  // namespace ibr::test
