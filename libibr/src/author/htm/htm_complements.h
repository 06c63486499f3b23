// SPDX-License-Identifier: Apache-2.0
// Turns matches of single vertices into complements of the whole mesh.
//
// [H] uses each match as measured. Vertices with plain, partly hidden or repetitive faces are then displaced at random.
// Here a pair's complements vary smoothly along the mesh, the more so the less certain its matches are; vertices
// without a match follow their neighbours. Neighbouring matches have similar errors, which smoothing keeps. A prior
// therefore shortens uncertain complements. The paper's method is smoothness 0.
#pragma once

#include <span>
#include <vector>

#include "author/htm/htm_match.h"

namespace ibr {

struct ComplementOptions {
  double smoothness = 10;  // 1 / px²: inverse variance of the difference between neighbours, >= 0
  double outlierPx = 2;    // a match this far from its neighbours has a quarter of its weight (Geman and McClure 1987)
  int threads = 0;
  double complementPx = 0;  // prior standard deviation of complements, px; 0: no prior
};

/// One at each complementIndex; 0 if i = j or a camera of the pair is not a member of the vertex.
std::vector<glm::vec2> complementsOf(const TriangleMesh& mesh, std::size_t cameras, std::span<const CameraSet> members,
                                     std::span<const VertexMatch> matches, const ComplementOptions& options);

}  // namespace ibr
