// SPDX-License-Identifier: Apache-2.0
// [H] Algs 4 and 5, eqs 2 to 4: how differently the cameras that see a face colour it.
#pragma once

#include <span>
#include <vector>

#include "author/htm/htm_visibility.h"

namespace ibr {

struct DifferenceOptions {
  double alpha = 0.3;  // of eq. 2: what facing the face counts, against size, 0 to 1
  double gamma1 = 10;  // of eq. 3, > 0
};

/// Eqs 2 and 3: e_k of each camera, which sum to 1. `facing`: V_Ck · N_f, the cosine between the face's normal and the
/// direction from the face to the camera, clamped to −1 … 1; `size`: s_f, its area in the camera's picture, px².
/// Computed relative to the largest, so that nothing underflows; all alike where all are behind or of no size.
std::vector<double> cameraScores(std::span<const double> facing, std::span<const double> size,
                                 const DifferenceOptions& options);

/// D_f (eq. 4) of the faces named, levels: against the best camera's colours, read where the complements say. 0 where
/// fewer than two cameras see it. `visibility`: of all faces; `complements`: at complementIndex, or empty: all 0.
std::vector<double> faceDifferences(const TriangleMesh& mesh, std::span<const ProjectedMesh> views,
                                    std::span<const FaceVisibility> visibility, std::span<const glm::vec2> complements,
                                    std::span<const std::uint32_t> faces, const DifferenceOptions& options,
                                    int threads);

}  // namespace ibr
