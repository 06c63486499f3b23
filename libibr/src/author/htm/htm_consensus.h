// SPDX-License-Identifier: Apache-2.0
// Cycle-consistent complements: one offset for each camera and vertex instead of one for each pair of cameras. All
// cameras that see the vertex agree on one surface point.
//
// The point that camera j sees b_j px away from the projected vertex, camera i sees at b_i = c_{i←j} + J_ij b_j. Here
// c_{i←j} is the match and J_ij maps the surface's tangent plane from image j to image i. The offsets b fit the matches
// in the least-squares sense, vary smoothly along the mesh and are minimal. The point is the mean of the cameras'
// claims, with a smaller error than each claim.
#pragma once

#include <span>
#include <vector>

#include "author/htm/htm_match.h"

namespace ibr {

struct ConsensusOptions {
  double smoothness = 100;  // 1 / px²: inverse variance of an offset's difference between neighbours
  double offsetPx = 4;      // prior standard deviation of offsets, px
  double outlierPx = 2;     // a match this far off has a quarter of its weight (Geman and McClure 1987)
  int sweeps = 120;
};

/// Returns the offsets of a mesh's vertices: b_i of vertex v at [i·n_v + v], px of image i; 0 where i is no member.
/// `progress` reports sweeps; throws Error{cancelled}.
std::vector<glm::vec2> consensusOffsets(const TriangleMesh& mesh, std::span<const HtmView> views,
                                        std::span<const CameraSet> members, std::span<const VertexMatch> matches,
                                        const ConsensusOptions& options, const ProgressCallback& progress = {});

/// Returns the complements b_i − J_ij b_j of the offsets, at complementIndex.
std::vector<glm::vec2> consistentComplements(const TriangleMesh& mesh, std::span<const HtmView> views,
                                             std::span<const CameraSet> members, std::span<const glm::vec2> offsets);

}  // namespace ibr
