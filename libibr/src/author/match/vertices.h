// SPDX-License-Identifier: Apache-2.0
// Vertices of a morphing mesh from a dense match, and a triangulation that folds over in no member.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "author/match/match.h"

namespace ibr {

/// Returns the vertices of a dense match: the matcher's own if present, else by quadtree (quadtree.h).
MatchedVertices matchedVertices(std::span<const MatchView> views, const DenseMatch& match);

template <class T>
void keepOnly(std::vector<T>& list, const std::vector<bool>& keep) {
  std::size_t kept = 0;
  for (std::size_t v = 0; v < list.size(); ++v)
    if (keep[v]) list[kept++] = list[v];
  list.resize(kept);
}

/// Triangulates `vertices`, which has count(), triangulate(), folded(triangle) and keepOnly(keep). While triangles fold
/// over, the vertex of each that most folded triangles share is dropped. Folds left after 30 passes are left to labels.
template <class Vertices>
std::vector<glm::uvec3> triangulateAndRepair(Vertices& vertices) {
  constexpr int kRepairs = 30;
  for (int pass = 0;; ++pass) {
    std::vector<glm::uvec3> triangles = vertices.triangulate();
    if (pass == kRepairs) return triangles;
    std::vector<unsigned> folds(vertices.count(), 0);
    std::vector<glm::uvec3> bad;
    for (const glm::uvec3& t : triangles)
      if (vertices.folded(t)) {
        bad.push_back(t);
        for (int k = 0; k < 3; ++k) ++folds[t[k]];
      }
    if (bad.empty()) return triangles;
    std::vector<bool> keep(vertices.count(), true);
    for (const glm::uvec3& t : bad) {
      if (!keep[t.x] || !keep[t.y] || !keep[t.z]) continue;
      unsigned worst = t.x;
      for (int k = 1; k < 3; ++k)
        if (folds[t[k]] > folds[worst]) worst = t[k];
      keep[worst] = false;
    }
    vertices.keepOnly(keep);
  }
}

}  // namespace ibr
