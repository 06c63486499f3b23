// SPDX-License-Identifier: Apache-2.0
// Delaunay triangulations of the plane, of space and of the sphere (CGAL, exact predicates).
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

namespace ibr {

/// Triangles as indices into `points`, counterclockwise where y points up, in an order that depends on the points only.
/// Of equal points the first is used. Empty where all points lie on a line. Precondition: all are finite.
std::vector<glm::uvec3> delaunayTriangles(std::span<const glm::dvec2> points);

/// Tetrahedra, likewise, each with ascending indices. Empty where all points lie in a plane.
std::vector<glm::uvec4> delaunayTetrahedra(std::span<const glm::dvec3> points);

/// Triangles on the sphere of directions (of any length, none zero), likewise: det(a, b, c) > 0. The part of the sphere
/// outside the convex hull of directions that lie in one hemisphere has no triangles. Directions closer to each other
/// than about 1e-7 rad count as equal. Empty where they lie on one circle.
std::vector<glm::uvec3> delaunaySphere(std::span<const glm::dvec3> directions);

}  // namespace ibr
