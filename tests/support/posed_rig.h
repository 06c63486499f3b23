// SPDX-License-Identifier: Apache-2.0
// Simulated rigs of cameras with the tracks they would share.
#pragma once

#include <fmt/format.h>
#include <cstddef>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <random>
#include <vector>

#include "base/file.h"
#include "ibr/author.h"

namespace ibr::test {

/// A camera at `position` that looks along `direction` with `up` up.
inline Camera lookingAlong(glm::dvec3 position, glm::dvec3 direction, int width = 200, int height = 150,
                           double fovY = 0.9, glm::dvec3 up = {0, 0, 1}) {
  const glm::dvec3 back = -glm::normalize(direction);
  const glm::dvec3 right = glm::normalize(glm::cross(up, back));
  const glm::dmat3 axes(right, glm::cross(back, right), back);
  return {pinholeFromFov(width, height, fovY), {position, glm::normalize(glm::quat_cast(axes))}};
}

/// A model of the cameras ("000", "001", … or given names) that see the points; where each is seen is exact.
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

/// Points on a sphere about `centre`, evenly spread at random.
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

/// Writes a model as COLMAP's text files.
inline void writeColmapModel(const PosedModel& model, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  std::string cameras, images, points;
  std::vector<std::string> seen(model.images.size());
  for (std::size_t t = 0; t < model.tracks.size(); ++t) {
    const glm::dvec3 p = model.tracks[t].position;
    points += fmt::format("{} {} {} {} 0 0 0 0\n", t + 1, p.x, p.y, p.z);
    for (const TrackObservation& o : model.tracks[t].observations)
      seen[o.image] += fmt::format("{} {} {} ", o.pixel.x, o.pixel.y, t + 1);
  }
  for (std::size_t i = 0; i < model.images.size(); ++i) {
    const Intrinsics& k = model.images[i].camera.intrinsics;
    cameras += fmt::format("{} PINHOLE {} {} {} {} {} {}\n", i + 1, k.width, k.height, k.fx, k.fy, k.cx, k.cy);
    const glm::dquat halfTurn(0, 1, 0, 0);  // COLMAP's axes: y down, z forward
    const glm::dquat q = glm::inverse(model.images[i].camera.pose.rotation * halfTurn);
    const glm::dvec3 t = -(q * model.images[i].camera.pose.position);
    images += fmt::format("{} {} {} {} {} {} {} {} {} {}\n{}\n", i + 1, q.w, q.x, q.y, q.z, t.x, t.y, t.z, i + 1,
                          model.images[i].name, seen[i]);
  }
  writeFile(folder / "cameras.txt", cameras);
  writeFile(folder / "images.txt", images);
  writeFile(folder / "points3D.txt", points);
}

}  // namespace ibr::test
