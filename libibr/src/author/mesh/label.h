// SPDX-License-Identifier: Apache-2.0
// How well the members agree inside each triangle of a morphing mesh ([T] §2.4.1: ECC as filtering criterion).
#pragma once

#include <span>
#include <vector>

#include "author/match/match.h"
#include "ibr/scene.h"

namespace ibr {

struct TriangleLabel {
  float ecc = 0;  // worst pair
  float rms = 0;  // grey levels, worst pair
  float off = 0;  // share of the samples where the dense match is missing or elsewhere, and it shows, or it is far off
  bool agrees() const;
};

/// Where a view is masked the others decide; where fewer than two are left, the sample counts as off. `frame` are the
/// vertices in the mean frame's picture, `member[i]` those in view i's picture.
std::vector<TriangleLabel> labelTriangles(std::span<const MatchView> views, const DenseMatch& match,
                                          std::span<const glm::vec2> frame,
                                          std::span<const std::vector<glm::vec2>> member,
                                          std::span<const glm::uvec3> triangles);

/// TriangleLabel::ecc alone, without a dense match: the mean of the members' positions, in px, stands for the frame.
/// `pictures` are RGB; `member[i]` are the vertices in picture i.
std::vector<float> worstPairEcc(std::span<const Image8* const> pictures, std::span<const std::vector<glm::vec2>> member,
                                std::span<const glm::uvec3> triangles);

}  // namespace ibr
