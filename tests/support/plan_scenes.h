// SPDX-License-Identifier: Apache-2.0
// Generated scenes of any number of cells and photographs, for planning. Nothing is on disk.
//
// Capture sites stand on a grid 1 world unit apart, slightly moved, on the ground y = 0. Each site has photographs in
// several directions. Around each square of sites a rough wall surrounds the views at 6 to 14 units.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numbers>
#include <string>
#include <vector>

#include <random>
#include "ibr/frame_plan.h"

namespace ibr::test {

struct PlanSceneShape {
  int columns = 4, rows = 4;  // sites
  int directions = 4;         // photographs of each site; a square of sites has two triangular cells for each direction
  int quads = 2;              // along each side of a cell's mesh; 0: no cells
  bool backdrops = false;     // each photograph has a backdrop with evidence, of one vertex
  unsigned seed = 1;
};

inline std::size_t cellCount(const PlanSceneShape& shape) {
  return shape.quads ? std::size_t(2 * shape.directions * (shape.columns - 1) * (shape.rows - 1)) : 0;
}

/// Returns a pinhole of 640×480 px with square pixels at a position, turned about the vertical axis.
inline Camera planCamera(glm::dvec3 position, double yaw, double fovY = 1.2) {
  return {pinholeFromFov(640, 480, fovY), {position, glm::angleAxis(yaw, glm::dvec3(0, 1, 0))}};
}

/// Adds a cell whose vertices lie over the first member's image, each at a distance of 6 to 14.
inline void addPlanCell(Scene& scene, std::vector<std::uint32_t> members, int quads, std::mt19937_64& random) {
  std::uniform_real_distribution<double> distance(6, 14);
  Cell cell;
  cell.members = std::move(members);
  MorphMesh& mesh = cell.mesh;
  mesh.match.resize(cell.members.size());
  mesh.ratio.resize(cell.members.size());
  const Camera& first = scene.nodes[cell.members[0]].camera;
  for (int row = 0; row <= quads; ++row)
    for (int column = 0; column <= quads; ++column) {
      const glm::dvec2 pixel(double(column) / quads * first.intrinsics.width,
                             double(row) / quads * first.intrinsics.height);
      const glm::dvec3 point =
          first.pose.position + first.pose.rotation * (distance(random) * unproject(first.intrinsics, pixel));
      double sum = 0;
      for (const std::uint32_t m : cell.members) sum += glm::distance(point, scene.nodes[m].camera.pose.position);
      const double inverse = double(cell.members.size()) / sum;
      for (std::size_t i = 0; i < cell.members.size(); ++i) {
        const Camera& camera = scene.nodes[cell.members[i]].camera;
        const glm::dvec3 away = glm::conjugate(camera.pose.rotation) * (point - camera.pose.position);
        mesh.match[i].push_back(glm::vec2(project(camera.intrinsics, away).value_or(pixel)));
        mesh.ratio[i].push_back(float(glm::length(away) * inverse));
      }
      mesh.inverseDistance.push_back(float(inverse));
      mesh.uncertainty.push_back(float(0.01 * inverse));
    }
  for (int row = 0; row < quads; ++row)
    for (int column = 0; column < quads; ++column) {
      const auto a = std::uint32_t(row * (quads + 1) + column), b = a + 1, c = a + std::uint32_t(quads) + 1, d = c + 1;
      mesh.triangles.emplace_back(a, c, b);
      mesh.triangles.emplace_back(b, c, d);
    }
  mesh.tier.assign(mesh.triangles.size(), kTierConsistent);
  mesh.ecc.assign(mesh.triangles.size(), 1.0f);
  scene.cells.push_back(std::move(cell));
}

inline Cell planBackdrop(std::uint32_t node) {
  Cell backdrop;
  backdrop.members = {node};
  backdrop.mesh.match = {{{320, 240}}};
  backdrop.mesh.ratio = {{1}};
  backdrop.mesh.inverseDistance = {0.1f};
  backdrop.mesh.uncertainty = {0.01f};
  backdrop.mesh.confirmations = {3};
  backdrop.mesh.consensus = {0.9f};
  return backdrop;
}

inline Scene makePlanScene(const PlanSceneShape& shape) {
  std::mt19937_64 random(shape.seed);
  std::uniform_real_distribution<double> jitter(-0.1, 0.1);
  Scene scene;
  const auto node = [&](int column, int row, int direction) {
    return std::uint32_t((row * shape.columns + column) * shape.directions + direction);
  };
  for (int row = 0; row < shape.rows; ++row)
    for (int column = 0; column < shape.columns; ++column) {
      const glm::dvec3 site(column + jitter(random), jitter(random), row + jitter(random));
      for (int direction = 0; direction < shape.directions; ++direction) {
        Node made;
        made.name = std::to_string(scene.nodes.size());
        made.camera = planCamera(site, 2 * std::numbers::pi * direction / shape.directions + jitter(random));
        if (shape.backdrops) {
          made.depthFile = "depth";
          made.depthScale = 1;
          scene.backdrops.push_back(planBackdrop(std::uint32_t(scene.nodes.size())));
        }
        scene.nodes.push_back(std::move(made));
      }
    }
  for (int row = 0; shape.quads && row + 1 < shape.rows; ++row)
    for (int column = 0; column + 1 < shape.columns; ++column)
      for (int d = 0; d < shape.directions; ++d) {
        const std::uint32_t right = node(column + 1, row, d), below = node(column, row + 1, d);
        addPlanCell(scene, {node(column, row, d), right, below}, shape.quads, random);
        addPlanCell(scene, {node(column + 1, row + 1, d), right, below}, shape.quads, random);
      }
  return scene;
}

/// Camera of a frame of a walk through the middle of such a scene, at 1.5 units a second and 60 frames a second. The
/// walk turns round in front of the scene's borders.
inline Camera planWalk(const PlanSceneShape& shape, int frame, int width = 1920, int height = 1080) {
  const double way = 0.025 * frame, length = std::max(0.5, shape.columns - 2.0);
  const double along = std::fmod(way, 2 * length), x = 0.5 + (along < length ? along : 2 * length - along);
  const double z = 0.5 * (shape.rows - 1) + 0.4 * std::sin(0.21 * way), yaw = 0.9 * way + std::sin(0.37 * way);
  return {pinholeFromFov(width, height, 1.0), {{x, 0.05 * std::sin(way), z}, glm::angleAxis(yaw, glm::dvec3(0, 1, 0))}};
}

}  // namespace ibr::test
