// SPDX-License-Identifier: Apache-2.0
// Invariants of an alignment's triangles, for any topology change. Implemented independently of the library.
#pragma once

#include <array>
#include <bit>
#include <catch2/catch.hpp>
#include <cstdint>
#include <glm/vec2.hpp>
#include <set>
#include <utility>
#include <vector>

#include "ibr/optimiser.h"
#include "optimise/texels.h"

namespace ibr::test {

inline std::vector<Texels> texelsOfAll(const Alignment& alignment) {
  std::vector<Texels> texels;
  for (const Image8* picture : alignment.pictures) texels.push_back(texelsOf(*picture));
  return texels;
}

/// Shoelace formula over the corners. Exact: doubles hold all products.
inline double twiceArea(const std::array<glm::dvec2, 3>& at) {
  double area = 0;
  for (std::size_t k = 0; k < 3; ++k) area += at[k].x * at[(k + 1) % 3].y - at[(k + 1) % 3].x * at[k].y;
  return area;
}

/// Checks each picture, the mean of each pair, and the mean of all pictures for a triangle of no or negative area.
inline bool foldedAnywhere(const std::vector<std::vector<glm::ivec2>>& at, const glm::uvec3& t) {
  for (unsigned set = 1; set < 1u << at.size(); ++set) {
    if (std::popcount(set) > 2 && set + 1 != 1u << at.size()) continue;
    std::array<glm::dvec2, 3> sum{};
    for (std::size_t i = 0; i < at.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k)
        if (set >> i & 1u) sum[k] += glm::dvec2(at[i][t[int(k)]]);
    if (twiceArea(sum) <= 0) return true;
  }
  return false;
}

inline std::set<std::set<std::uint32_t>> cornersOf(const std::vector<glm::uvec3>& triangles) {
  std::set<std::set<std::uint32_t>> all;
  for (const glm::uvec3& t : triangles) all.insert({t.x, t.y, t.z});
  return all;
}

/// Returns the directed edges that have no opposite edge; checks that no directed edge occurs twice.
inline std::set<std::pair<unsigned, unsigned>> borderOf(const std::vector<glm::uvec3>& triangles) {
  std::set<std::pair<unsigned, unsigned>> edges;
  for (const glm::uvec3& t : triangles)
    for (int k = 0; k < 3; ++k) CHECK(edges.emplace(t[k], t[(k + 1) % 3]).second);
  auto border = edges;
  for (const auto& [a, b] : edges) border.erase({edges.contains({b, a}) ? a : ~0u, b});
  return border;
}

}  // namespace ibr::test
