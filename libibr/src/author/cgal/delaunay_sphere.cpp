// SPDX-License-Identifier: Apache-2.0
#include <CGAL/Delaunay_triangulation_on_sphere_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Projection_on_sphere_traits_3.h>
#include <CGAL/Triangulation_on_sphere_face_base_2.h>
#include <CGAL/Triangulation_on_sphere_vertex_base_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <array>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "author/cgal/delaunay.h"

namespace ibr {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Traits = CGAL::Projection_on_sphere_traits_3<Kernel>;
using Vertex =
    CGAL::Triangulation_vertex_base_with_info_2<unsigned, Traits, CGAL::Triangulation_on_sphere_vertex_base_2<Traits>>;
using Sphere = CGAL::Delaunay_triangulation_on_sphere_2<
    Traits, CGAL::Triangulation_data_structure_2<Vertex, CGAL::Triangulation_on_sphere_face_base_2<Traits>>>;

}  // namespace

std::vector<glm::uvec3> delaunaySphere(std::span<const glm::dvec3> directions) {
  Sphere sphere;
  Sphere::Face_handle near;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const glm::dvec3 d = glm::normalize(directions[i]);
    const std::size_t before = sphere.number_of_vertices();
    const auto vertex = sphere.insert(Kernel::Point_3(d.x, d.y, d.z), near);
    if (sphere.number_of_vertices() == before) continue;  // equal to an earlier one, which keeps its index
    vertex->info() = unsigned(i);
    near = vertex->face();
  }
  std::vector<glm::uvec3> triangles;
  if (sphere.dimension() < 2) return triangles;
  for (const auto face : sphere.solid_faces()) {
    std::array<unsigned, 3> v{face->vertex(0)->info(), face->vertex(1)->info(), face->vertex(2)->info()};
    if (glm::determinant(glm::dmat3(directions[v[0]], directions[v[1]], directions[v[2]])) < 0) std::swap(v[1], v[2]);
    std::rotate(v.begin(), std::min_element(v.begin(), v.end()), v.end());
    triangles.emplace_back(v[0], v[1], v[2]);
  }
  std::sort(triangles.begin(), triangles.end(), [](const glm::uvec3& a, const glm::uvec3& b) {
    return std::array{a.x, a.y, a.z} < std::array{b.x, b.y, b.z};
  });
  return triangles;
}

}  // namespace ibr
