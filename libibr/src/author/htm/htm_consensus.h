// SPDX-License-Identifier: Apache-2.0
// Cycle-consistent complements: not one for each two cameras, but for each camera where it shows a point on which all
// that see the vertex settle.
//
// What camera j shows b_j px away from the projected vertex, camera i shows at b_i, where b_i = c_{i←j} + J_ij b_j;
// c_{i←j} is their match and J_ij the map between the two pictures of the surface's tangent plane. The offsets b fit
// the matches in the sense of least squares, change smoothly along the mesh and are as small as they can be: the point
// is the mean of what the cameras claim, which errs less than any of them.
#pragma once

#include <span>
#include <vector>

#include "author/htm/htm_match.h"

namespace ibr {

struct ConsensusOptions {
  double smoothness = 100;  // 1 / px²: inverse variance of an offset's difference between neighbours
  double offsetPx = 4;      // standard deviation that offsets have before anything is matched
  double outlierPx = 2;     // a match further off than this loses its weight (Geman and McClure 1987)
  int sweeps = 120;
};

/// What the offsets of a mesh's vertices are: b_i of vertex v at [i·n_v + v], px of picture i; 0 where i is no member.
/// `progress` reports sweeps; throws Error{cancelled}.
std::vector<glm::vec2> consensusOffsets(const TriangleMesh& mesh, std::span<const HtmView> views,
                                        std::span<const CameraSet> members, std::span<const VertexMatch> matches,
                                        const ConsensusOptions& options, const ProgressCallback& progress = {});

/// The complements b_i − J_ij b_j that follow, at complementIndex.
std::vector<glm::vec2> consistentComplements(const TriangleMesh& mesh, std::span<const HtmView> views,
                                             std::span<const CameraSet> members, std::span<const glm::vec2> offsets);

}  // namespace ibr
