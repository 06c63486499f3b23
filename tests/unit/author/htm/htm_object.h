// SPDX-License-Identifier: Apache-2.0
// Synthetic cameras and objects for the tests of texture harmonisation.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/vector_relational.hpp>
#include <optional>
#include <vector>

#include "author/htm/htm_views.h"
#include "ibr/author/htm.h"
#include "support/bumpy_model.h"

namespace ibr::test {

inline Camera lookingAt(glm::dvec3 from, glm::dvec3 at, int width = 120, int height = 90, double fovY = 0.8,
                        glm::dvec3 up = {0, 1, 0}) {
  const glm::dvec3 back = glm::normalize(from - at), right = glm::normalize(glm::cross(up, back));
  return {pinholeFromFov(width, height, fovY),
          {from, glm::normalize(glm::quat_cast(glm::dmat3(right, glm::cross(back, right), back)))}};
}

inline Image8 plain(const Intrinsics& k, std::array<std::uint8_t, 3> colour = {100, 100, 100}) {
  Image8 picture(k.width, k.height, 3);
  for (std::size_t p = 0; p < picture.values.size(); ++p) picture.values[p] = colour[p % 3];
  return picture;
}
inline HtmView plainView(const Camera& camera, std::array<std::uint8_t, 3> colour = {100, 100, 100}) {
  return {camera, plain(camera.intrinsics, colour), {}};
}

inline std::vector<HtmPhotograph> photographsOf(const BumpyModel& bumpy) {
  std::vector<HtmPhotograph> photographs;
  for (std::size_t i = 0; i < bumpy.pictures.size(); ++i)
    photographs.push_back({bumpy.model.cameras[i], bumpy.pictures[i].photograph, {}});
  return photographs;
}
inline std::vector<HtmView> viewsOf(const BumpyModel& bumpy) {
  std::vector<HtmView> views;
  for (std::size_t i = 0; i < bumpy.pictures.size(); ++i)
    views.push_back({bumpy.model.cameras[i].camera, bumpy.pictures[i].photograph, {}});
  return views;
}

inline TriangleMesh moved(TriangleMesh mesh, glm::dvec3 by) {
  for (glm::dvec3& position : mesh.positions) position += by;
  return mesh;
}

/// Distances of a vertex in front of a camera that almost touches the vertex, down to the smallest number.
inline constexpr std::array kBarelyBefore{1e-3, 1e-9, 1e-300, 5e-324};

/// Camera above the ground, at the origin. groundUpTo(): one ground face with a corner at depth `before`; the corner
/// projects to 10¹¹ px for `before` = 10⁻⁹.
inline Camera aboveGround() {
  return lookingAt({0, 0, 0}, {0, 0, -1});
}
inline TriangleMesh groundUpTo(double before) {
  return {{{5, -1.5, -12}, {-5, -1.5, -12}, {0, -1.5, -before}}, {{0, 1, 2}}};
}

/// Returns the first point of the mesh on the ray through a pixel.
inline std::optional<glm::dvec3> pointBehind(const TriangleMesh& mesh, const Camera& camera, glm::dvec2 pixel) {
  const PinholeView view(camera);
  const glm::dvec3 from = view.centre(), along = view.point(pixel, 1) - from;
  double nearest = INFINITY;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 a = mesh.positions[t.x] - from, b = mesh.positions[t.y] - from, c = mesh.positions[t.z] - from;
    const glm::dvec3 share(glm::dot(along, glm::cross(b, c)), glm::dot(along, glm::cross(c, a)),
                           glm::dot(along, glm::cross(a, b)));
    const double all = share.x + share.y + share.z;
    if (all == 0 || glm::any(glm::lessThan(share / all, glm::dvec3(-1e-9)))) continue;
    const double depth = glm::dot((share.x * a + share.y * b + share.z * c) / all, along) / glm::dot(along, along);
    if (depth > 0) nearest = std::min(nearest, depth);
  }
  return std::isinf(nearest) ? std::nullopt : std::optional(from + nearest * along);
}

/// Returns a camera with a pose error: a turn of up to `turn` radians and a shift of up to `shift` along each axis.
inline Camera disturbed(Camera camera, double turn, double shift, int seed) {
  const auto wave = [&](int k) { return std::sin(12.9 * seed + 7.3 * k + 1); };
  camera.pose.rotation = glm::normalize(glm::angleAxis(turn * wave(0), glm::dvec3(0, 1, 0)) *
                                        glm::angleAxis(turn * wave(1), glm::dvec3(1, 0, 0)) * camera.pose.rotation);
  camera.pose.position += shift * glm::dvec3(wave(2), wave(3), wave(4));
  return camera;
}

/// Returns the exact complements at complementIndex. Pictures were taken with truly[], vertices are projected with
/// given[]: position in i of the surface that j shows at a vertex, minus the vertex in i. NaN: no such surface.
inline std::vector<glm::vec2> trueComplements(const TriangleMesh& mesh, const std::vector<Camera>& truly,
                                              const std::vector<Camera>& given) {
  const std::size_t n = mesh.positions.size(), cameras = truly.size();
  std::vector<glm::vec2> complements(cameras * cameras * n, glm::vec2(NAN));
  for (std::size_t j = 0; j < cameras; ++j)
    for (std::size_t v = 0; v < n; ++v) {
      const auto at = PinholeView(given[j]).seen(mesh.positions[v]);
      const auto point = at ? pointBehind(mesh, truly[j], at->pixel) : std::nullopt;
      if (!point) continue;
      for (std::size_t i = 0; i < cameras; ++i) {
        const auto there = PinholeView(truly[i]).seen(*point), here = PinholeView(given[i]).seen(mesh.positions[v]);
        if (there && here) complements[(i * cameras + j) * n + v] = glm::vec2(there->pixel - here->pixel);
      }
    }
  return complements;
}

}  // namespace ibr::test
