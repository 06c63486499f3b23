// SPDX-License-Identifier: Apache-2.0
#include "optimise/mesh_edges.h"

namespace ibr {

MeshEdges::MeshEdges(const Alignment& alignment) {
  for (std::size_t t = 0; t < alignment.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const glm::uvec3& corner = alignment.triangles[t];
      const std::uint32_t a = corner[k], b = corner[(k + 1) % 3];
      all.insert(either(a, b));
      if (!beside.emplace(Edge(a, b), t).second) barred.insert(either(a, b));
    }
  for (const glm::uvec3& corner : alignment.unevaluated)
    for (int k = 0; k < 3; ++k) {
      const Edge edge = either(corner[k], corner[(k + 1) % 3]);
      all.insert(edge);
      barred.insert(edge);
    }
}

std::size_t MeshEdges::beyond(std::uint32_t a, std::uint32_t b) const {
  const auto other = beside.find({b, a});
  return other == beside.end() || barred.contains(either(a, b)) ? none : other->second;
}

std::uint32_t opposite(const glm::uvec3& triangle, std::uint32_t a, std::uint32_t b) {
  for (int k = 0; k < 2; ++k)
    if (triangle[k] != a && triangle[k] != b) return triangle[k];
  return triangle.z;
}

}  // namespace ibr
