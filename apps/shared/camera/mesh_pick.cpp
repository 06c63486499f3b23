// SPDX-License-Identifier: Apache-2.0
#include "shared/camera/mesh_pick.h"

#include <glm/geometric.hpp>
#include <limits>

namespace ibr::app {

// Möller and Trumbore 1997, by Cramer's rule: eye + t·d = a + u·(b − a) + v·(c − a).
std::optional<glm::dvec3> pickedPoint(const TriangleMesh& mesh, glm::dvec3 eye, glm::dvec3 direction) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const glm::uvec3& triangle : mesh.triangles) {
    const glm::dvec3 a = mesh.positions[triangle.x];
    const glm::dvec3 ab = mesh.positions[triangle.y] - a, ac = mesh.positions[triangle.z] - a, from = eye - a;
    const glm::dvec3 p = glm::cross(direction, ac), q = glm::cross(from, ab);
    const double determinant = glm::dot(ab, p);
    const double u = glm::dot(from, p) / determinant, v = glm::dot(direction, q) / determinant,
                 t = glm::dot(ac, q) / determinant;
    if (u >= 0 && v >= 0 && u + v <= 1 && t > 0 && t < nearest) nearest = t;  // all comparisons are false for NaN
  }
  if (nearest == std::numeric_limits<double>::infinity()) return std::nullopt;
  return eye + nearest * direction;
}

}  // namespace ibr::app
