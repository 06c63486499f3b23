// SPDX-License-Identifier: Apache-2.0
#include "lab/generate/photograph_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace ibr {
namespace {

constexpr double kFloor = -1.6, kCeiling = 2.4;  // from the cameras, m
constexpr double kFarthest = 30;                 // along the viewing direction, m
constexpr double kFov = 1.8;                     // of photographs, radians
constexpr int kQuads = 51;                       // along each side of a mesh
constexpr glm::dvec2 kMeshExtent{0.9, 0.8};      // tangents: all members see a mesh of this extent

// Point that is seen along `direction`, whose z is −1.
glm::dvec3 surfacePoint(glm::dvec3 from, glm::dvec3 direction) {
  double depth = kFarthest;
  if (direction.y < 0) depth = std::min(depth, kFloor / direction.y);
  if (direction.y > 0) depth = std::min(depth, kCeiling / direction.y);
  return from + depth * direction;
}

MorphMesh meshOf(const Scene& scene, const std::vector<std::uint32_t>& members) {
  MorphMesh mesh;
  mesh.match.resize(members.size());
  mesh.ratio.resize(members.size());
  glm::dvec3 middle(0.0);
  for (const std::uint32_t member : members)
    middle += scene.nodes[member].camera.pose.position / double(members.size());
  std::vector<double> distance(members.size());
  for (int row = 0; row <= kQuads; ++row)
    for (int column = 0; column <= kQuads; ++column) {
      const glm::dvec2 share = glm::dvec2(column, row) / double(kQuads);
      const glm::dvec3 point =
          surfacePoint(middle, glm::dvec3(glm::mix(-kMeshExtent, kMeshExtent, share) * glm::dvec2(1, -1), -1.0));
      double mean = 0;
      for (std::size_t i = 0; i < members.size(); ++i) {
        const Camera& camera = scene.nodes[members[i]].camera;
        const glm::dvec3 toPoint = point - camera.pose.position;  // cameras are not rotated
        mesh.match[i].emplace_back(*project(camera.intrinsics, toPoint));
        distance[i] = glm::length(toPoint);
        mean += distance[i] / double(members.size());
      }
      for (std::size_t i = 0; i < members.size(); ++i) mesh.ratio[i].push_back(float(distance[i] / mean));
      mesh.inverseDistance.push_back(float(1 / mean));
      mesh.uncertainty.push_back(0.0f);
    }
  for (std::uint32_t row = 0; row < kQuads; ++row)
    for (std::uint32_t column = 0; column < kQuads; ++column) {
      const std::uint32_t a = row * (kQuads + 1) + column, b = a + 1, c = a + kQuads + 1, d = c + 1;
      mesh.triangles.insert(mesh.triangles.end(), {{a, c, b}, {b, c, d}});
    }
  mesh.tier.assign(mesh.triangles.size(), kTierConsistent);
  mesh.ecc.assign(mesh.triangles.size(), 1.0f);
  return mesh;
}

// A band-limited pattern that does not repeat within a field.
glm::vec3 colourAt(glm::dvec3 point) {
  const auto x = float(point.x), y = float(point.y), z = float(point.z);
  const float broad = std::sin(0.71f * x + 0.23f * z + y) + std::sin(0.17f * x - 0.57f * z);
  const float fine = std::sin(5.3f * x + 2.9f * std::sin(1.3f * z)) * std::sin(4.7f * z + 2.1f * std::sin(0.9f * x));
  return glm::vec3(128 + 30 * broad + 50 * fine, 128 + 50 * fine, 128 - 30 * broad + 50 * fine);
}

}  // namespace

Scene photographField(int side, int size, const std::filesystem::path& folder) {
  assert(side >= 2);
  Scene scene;
  scene.folder = folder;
  for (int z = 0; z < side; ++z)
    for (int x = 0; x < side; ++x) {
      Node& node = scene.nodes.emplace_back();
      node.name = fmt::format("{}-{}", x, z);
      node.camera = {pinholeFromFov(size, size, kFov), {{x, 0, z}, {1, 0, 0, 0}}};
      node.textureFile = fmt::format("{}.ktx2", scene.nodes.size() - 1);
    }
  const auto add = [&](std::vector<std::uint32_t> members) {
    Cell& cell = scene.cells.emplace_back();
    cell.mesh = meshOf(scene, members);
    cell.members = std::move(members);
  };
  const auto row = std::uint32_t(side);
  for (std::uint32_t z = 0; z + 1 < row; ++z)
    for (std::uint32_t x = 0; x + 1 < row; ++x) {
      const std::uint32_t n = z * row + x;
      add({n, n + 1, n + row});
      add({n + 1, n + row + 1, n + row});
    }
  return scene;
}

Image8 fieldPhotograph(const Scene& scene, std::size_t node) {
  const Camera& camera = scene.nodes[node].camera;
  const Intrinsics& k = camera.intrinsics;
  Image8 picture(k.width, k.height, 3);
  for (int y = 0; y < k.height; ++y)
    for (int x = 0; x < k.width; ++x) {
      const glm::dvec3 direction((x + 0.5 - k.cx) / k.fx, (k.cy - y - 0.5) / k.fy, -1.0);
      const glm::vec3 colour = glm::clamp(colourAt(surfacePoint(camera.pose.position, direction)), 0.0f, 255.0f);
      for (int c = 0; c < 3; ++c) picture.pixel(x, y)[std::size_t(c)] = std::uint8_t(colour[c] + 0.5f);
    }
  return picture;
}

}  // namespace ibr
