// SPDX-License-Identifier: Apache-2.0
// Measures how well the members agree inside each triangle of a morphing mesh ([T] §2.4.1: ECC as filtering criterion).
#pragma once

#include <span>
#include <vector>

#include "author/match/match.h"
#include "ibr/scene.h"

namespace ibr {

struct TriangleLabel {
  float ecc = 0;  // worst pair
  float rms = 0;  // grey levels, worst pair
  float off = 0;  // share of samples whose dense match is missing or elsewhere with a visible difference, or is far off
  bool agrees() const;
};

/// Masked views are left out; a sample with fewer than two remaining views counts as off. `frame`: the vertices in the
/// mean frame's image; `member[i]`: in view i's image.
std::vector<TriangleLabel> labelTriangles(std::span<const MatchView> views, const DenseMatch& match,
                                          std::span<const glm::vec2> frame,
                                          std::span<const std::vector<glm::vec2>> member,
                                          std::span<const glm::uvec3> triangles);

/// Computes TriangleLabel::ecc only, without a dense match: the mean of the members' positions, in px, replaces the
/// frame. `pictures`: RGB; `member[i]`: the vertices in picture i.
std::vector<float> worstPairEcc(std::span<const Image8* const> pictures, std::span<const std::vector<glm::vec2>> member,
                                std::span<const glm::uvec3> triangles);

}  // namespace ibr
