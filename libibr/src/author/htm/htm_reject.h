// SPDX-License-Identifier: Apache-2.0
// Rejects cameras with wholly different textures, a failure case of [H]. A camera whose image cannot be aligned with
// the others at a vertex neither deforms nor blends there.
#pragma once

#include <span>
#include <vector>

#include "author/htm/htm_segment.h"
#include "author/htm/htm_views.h"

namespace ibr {

struct RejectOptions {
  double maxDifference = 45;    // [H] eq. 1 at the complement, 8-bit levels: above it two cameras disagree, …
  double minCorrelation = 0.2;  // … unless their colours correlate at least this much
  SegmentOptions segment;
};

/// Comparison of two cameras at a vertex, with the complement applied.
struct CameraAgreement {
  float difference = 0;   // [H] eq. 1, 8-bit levels
  float correlation = 0;  // zero-mean, normalised, −1 to 1; 0 if either side is flat
  bool known = false;     // the cameras share enough pixels there
};

/// One at each complementIndex.
std::vector<CameraAgreement> agreements(const TriangleMesh& mesh, std::span<const ProjectedMesh> views,
                                        std::span<const CameraSet> members, std::span<const glm::vec2> complements,
                                        const SegmentOptions& segment, int threads);

/// Returns the cosine between each vertex's normal and the direction to each camera; 0 if the cosine is negative or the
/// vertex has no normal; n_c × n_v.
std::vector<float> facingScores(const TriangleMesh& mesh, std::span<const ProjectedMesh> views);

/// Returns the remaining members: for each vertex the largest set of cameras that agree pairwise, in both directions if
/// both are known. Pairs that are not known count as agreeing. Among sets of equal size the sum of scores decides.
/// `scores`: n_c × n_v, value of each camera's view of a vertex.
std::vector<CameraSet> agreeingMembers(std::size_t cameras, std::span<const CameraSet> members,
                                       std::span<const CameraAgreement> agreements, std::span<const float> scores,
                                       const RejectOptions& options);

/// Returns the largest pairwise joined set in `among`. Bit b of joined[a]: a and b are joined (symmetric). Among equal
/// sizes the sum of scores decides. After 10⁵ steps the search returns its best set, at least a greedy one.
CameraSet largestClique(CameraSet among, std::span<const CameraSet> joined, std::span<const float> scores);

}  // namespace ibr
