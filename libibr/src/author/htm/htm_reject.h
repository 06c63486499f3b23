// SPDX-License-Identifier: Apache-2.0
// Textures that are wholly different, which [H] names as its failure: cameras that do not agree on a vertex, however
// their pictures are displaced, neither deform nor blend there.
#pragma once

#include <span>
#include <vector>

#include "author/htm/htm_segment.h"
#include "author/htm/htm_views.h"

namespace ibr {

struct RejectOptions {
  double mostDifference = 45;     // [H] eq. 1 at the complement, levels: beyond it two cameras do not agree, …
  double leastCorrelation = 0.2;  // … unless their colours go up and down together
  SegmentOptions segment;
};

/// How two cameras compare at a vertex, where the complement says.
struct CameraAgreement {
  float difference = 0;   // [H] eq. 1, levels
  float correlation = 0;  // zero-mean and normalised, −1 to 1; 0 where either side is flat
  bool known = false;     // they share enough pixels there
};

/// One at each complementIndex.
std::vector<CameraAgreement> agreements(const TriangleMesh& mesh, std::span<const ProjectedMesh> views,
                                        std::span<const CameraSet> members, std::span<const glm::vec2> complements,
                                        const SegmentOptions& segment, int threads);

/// How much each camera looks at each vertex from its front: the cosine between the vertex's normal and the direction
/// to the camera, 0 where it is negative or there is none; n_c × n_v.
std::vector<float> facingScores(const TriangleMesh& mesh, std::span<const ProjectedMesh> views);

/// The members that remain: for each vertex the largest set of cameras of which each two agree, both ways where both
/// are known; pairs that are not known do not disagree. Of several largest the one whose scores sum to the most.
/// `scores`: n_c × n_v, what each camera's view of a vertex is worth.
std::vector<CameraSet> agreeingMembers(std::size_t cameras, std::span<const CameraSet> members,
                                       std::span<const CameraAgreement> agreements, std::span<const float> scores,
                                       const RejectOptions& options);

/// The largest set within `among` of which each two are joined; bit b of joined[a] says that a and b are, b and a too.
/// Of several largest the one with the largest sum of scores; a greedy one where the search takes more than 10⁵ steps.
CameraSet largestClique(CameraSet among, std::span<const CameraSet> joined, std::span<const float> scores);

}  // namespace ibr
