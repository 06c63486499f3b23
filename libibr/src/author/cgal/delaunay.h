// SPDX-License-Identifier: Apache-2.0
// Delaunay triangulations in the plane, in space and on the sphere (CGAL, exact predicates).
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

namespace ibr {

/// Triangles as indices into `points`, counterclockwise if y points up. Their order depends on the points only. Of
/// equal points the first is used. Empty if all points lie on a line. Precondition: all points are finite.
std::vector<glm::uvec3> delaunayTriangles(std::span<const glm::dvec2> points);

/// Tetrahedra, likewise, each with ascending indices. Empty if all points lie in a plane.
std::vector<glm::uvec4> delaunayTetrahedra(std::span<const glm::dvec3> points);

/// Triangles on the sphere of directions (any length, none zero), likewise, with det(a, b, c) > 0. If all directions
/// lie in one hemisphere, the sphere outside their convex hull has no triangles. Directions closer than about 1e-7 rad
/// count as equal. Empty if all directions lie on one circle.
std::vector<glm::uvec3> delaunaySphere(std::span<const glm::dvec3> directions);

}  // namespace ibr
