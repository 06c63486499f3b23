// SPDX-License-Identifier: Apache-2.0
#include "author/cgal/surface_distance.h"

#define CGAL_NO_DEPRECATION_WARNINGS  // CGAL 6 (Debian 13) has new names, which CGAL 5 (Debian 12) lacks
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>

namespace ibr {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

Kernel::Point_3 point(glm::dvec3 p) {
  return {p.x, p.y, p.z};
}

}  // namespace

SurfaceDistance surfaceDistance(const TriangleMesh& from, const TriangleMesh& to, std::size_t samples,
                                std::uint64_t seed) {
  Triangles triangles;
  for (const glm::uvec3& t : to.triangles) {
    const Kernel::Triangle_3 triangle(point(to.positions[t.x]), point(to.positions[t.y]), point(to.positions[t.z]));
    if (!triangle.is_degenerate()) triangles.push_back(triangle);
  }
  Tree tree(triangles.begin(), triangles.end());
  tree.accelerate_distance_queries();

  std::vector<double> sum;
  double total = 0;
  for (const glm::uvec3& t : from.triangles) {
    const glm::dvec3 a = from.positions[t.x];
    total += 0.5 * glm::length(glm::cross(from.positions[t.y] - a, from.positions[t.z] - a));
    sum.push_back(total);
  }
  std::mt19937_64 random(seed);
  const auto unit = [&] { return double(random() >> 11) * 0x1p-53; };
  std::vector<double> distances;
  for (std::size_t i = 0; i < samples; ++i) {
    const double wanted = (double(i) + unit()) / double(samples) * total;
    const auto face = std::min(std::size_t(std::lower_bound(sum.begin(), sum.end(), wanted) - sum.begin()),
                               from.triangles.size() - 1);
    const glm::uvec3 t = from.triangles[face];
    const double root = std::sqrt(unit()), part = unit();
    const glm::dvec3 p = (1.0 - root) * from.positions[t.x] + root * (1.0 - part) * from.positions[t.y] +
                         root * part * from.positions[t.z];
    distances.push_back(std::sqrt(tree.squared_distance(point(p))));
  }
  std::sort(distances.begin(), distances.end());
  SurfaceDistance result;
  result.samples = distances.size();
  if (distances.empty()) return result;
  for (const double d : distances) result.mean += d / double(distances.size());
  result.p95 = distances[(distances.size() - 1) * 95 / 100];
  result.max = distances.back();
  return result;
}

}  // namespace ibr
