// SPDX-License-Identifier: Apache-2.0
#include "author/cgal/delaunay.h"

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>

#include <algorithm>
#include <array>
#include <map>
#include <utility>

namespace ibr {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Plane = CGAL::Delaunay_triangulation_2<
    Kernel, CGAL::Triangulation_data_structure_2<CGAL::Triangulation_vertex_base_with_info_2<unsigned, Kernel>>>;
using Space = CGAL::Delaunay_triangulation_3<
    Kernel, CGAL::Triangulation_data_structure_3<CGAL::Triangulation_vertex_base_with_info_3<unsigned, Kernel>,
                                                 CGAL::Delaunay_triangulation_cell_base_3<Kernel>>>;

}  // namespace

std::vector<glm::uvec3> delaunayTriangles(std::span<const glm::dvec2> points) {
  // CGAL keeps an arbitrary one of equal points; passing only the first makes the result deterministic.
  std::map<std::pair<double, double>, unsigned> first;
  for (std::size_t i = 0; i < points.size(); ++i) first.emplace(std::pair(points[i].x, points[i].y), unsigned(i));
  std::vector<std::pair<Plane::Point, unsigned>> input;
  for (const auto& [at, index] : first) input.emplace_back(Plane::Point(at.first, at.second), index);
  const Plane plane(input.begin(), input.end());
  std::vector<glm::uvec3> triangles;
  if (plane.dimension() < 2) return triangles;
  triangles.reserve(plane.number_of_faces());
  for (const auto face : plane.finite_face_handles()) {
    std::array<unsigned, 3> v{face->vertex(0)->info(), face->vertex(1)->info(), face->vertex(2)->info()};
    std::rotate(v.begin(), std::min_element(v.begin(), v.end()), v.end());
    triangles.emplace_back(v[0], v[1], v[2]);
  }
  std::sort(triangles.begin(), triangles.end(), [](const glm::uvec3& a, const glm::uvec3& b) {
    return std::array{a.x, a.y, a.z} < std::array{b.x, b.y, b.z};
  });
  return triangles;
}

std::vector<glm::uvec4> delaunayTetrahedra(std::span<const glm::dvec3> points) {
  std::map<std::array<double, 3>, unsigned> first;
  for (std::size_t i = 0; i < points.size(); ++i)
    first.emplace(std::array{points[i].x, points[i].y, points[i].z}, unsigned(i));
  std::vector<std::pair<Space::Point, unsigned>> input;
  for (const auto& [at, index] : first) input.emplace_back(Space::Point(at[0], at[1], at[2]), index);
  const Space space(input.begin(), input.end());
  std::vector<std::array<unsigned, 4>> cells;
  if (space.dimension() == 3)
    for (const auto cell : space.finite_cell_handles()) {
      std::array<unsigned, 4> v{};
      for (int i = 0; i < 4; ++i) v[std::size_t(i)] = cell->vertex(i)->info();
      std::sort(v.begin(), v.end());
      cells.push_back(v);
    }
  std::sort(cells.begin(), cells.end());
  std::vector<glm::uvec4> tetrahedra;
  for (const auto& v : cells) tetrahedra.emplace_back(v[0], v[1], v[2], v[3]);
  return tetrahedra;
}

}  // namespace ibr
