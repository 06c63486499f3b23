// SPDX-License-Identifier: Apache-2.0
// From matches of single vertices to complements of the whole mesh.
//
// [H] takes each match as it is. A vertex whose faces are plain, hidden in part or repeat themselves is then displaced
// at random; here a pair's complements change smoothly along the mesh as far as its matches are uncertain, so that
// those without a match follow those around them. Matches of neighbours err alike, which smoothness does not take away:
// a prior keeps short what would be error for the most part. smoothness 0 is the paper's way.
#pragma once

#include <span>
#include <vector>

#include "author/htm/htm_match.h"

namespace ibr {

struct ComplementOptions {
  double smoothness = 10;  // 1 / px²: inverse variance of the difference between neighbours, >= 0
  double outlierPx = 2;    // a match further than this from what is around it loses its weight (Geman and McClure 1987)
  int threads = 0;
  double complementPx =
      0;  // standard deviation that complements have before anything is matched; 0: any length is alike
};

/// One at each complementIndex; 0 where i = j and where a camera of the pair is no member of the vertex.
std::vector<glm::vec2> complementsOf(const TriangleMesh& mesh, std::size_t cameras, std::span<const CameraSet> members,
                                     std::span<const VertexMatch> matches, const ComplementOptions& options);

}  // namespace ibr
