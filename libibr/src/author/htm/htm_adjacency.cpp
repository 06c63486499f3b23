// SPDX-License-Identifier: Apache-2.0
#include "author/htm/htm_adjacency.h"

#include <algorithm>

namespace ibr {
namespace {

Lists listsOf(const std::vector<std::vector<std::uint32_t>>& each) {
  Lists lists{{0}, {}};
  for (const auto& list : each) {
    lists.values.insert(lists.values.end(), list.begin(), list.end());
    lists.first.push_back(std::uint32_t(lists.values.size()));
  }
  return lists;
}

}  // namespace

Lists facesAtVertices(const TriangleMesh& mesh) {
  std::vector<std::vector<std::uint32_t>> each(mesh.positions.size());
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f)
    for (int k = 0; k < 3; ++k) each[mesh.triangles[f][k]].push_back(std::uint32_t(f));
  return listsOf(each);
}

Lists neighboursOfVertices(const TriangleMesh& mesh) {
  std::vector<std::vector<std::uint32_t>> each(mesh.positions.size());
  for (const glm::uvec3& corner : mesh.triangles)
    for (int k = 0; k < 3; ++k) {
      each[corner[k]].push_back(corner[(k + 1) % 3]);
      each[corner[k]].push_back(corner[(k + 2) % 3]);
    }
  for (auto& list : each) {
    std::ranges::sort(list);
    list.erase(std::ranges::unique(list).begin(), list.end());
  }
  return listsOf(each);
}

}  // namespace ibr
