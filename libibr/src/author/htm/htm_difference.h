// SPDX-License-Identifier: Apache-2.0
// Colour differences of a face between the cameras that see the face: [H] Algs 4 and 5, eqs 2 to 4.
#pragma once

#include <span>
#include <vector>

#include "author/htm/htm_visibility.h"

namespace ibr {

struct DifferenceOptions {
  double alpha = 0.3;  // of eq. 2: weight of facing the face, against its size, 0 to 1
  double gamma1 = 10;  // of eq. 3, > 0
};

/// Eqs 2 and 3: e_k of each camera; the sum is 1. `facing`: V_Ck · N_f, the cosine between the face's normal and the
/// direction from the face to the camera, clamped to −1 … 1. `size`: s_f, area in the camera's image, px². Computed
/// relative to the largest against underflow; equal if all cameras are behind the face or see no area.
std::vector<double> cameraScores(std::span<const double> facing, std::span<const double> size,
                                 const DifferenceOptions& options);

/// D_f (eq. 4) of the listed faces against the best camera's colours, sampled with the complements; 8-bit levels. 0 if
/// fewer than two cameras see the face. `visibility`: of all faces; `complements`: at complementIndex; empty: all 0.
std::vector<double> faceDifferences(const TriangleMesh& mesh, std::span<const ProjectedMesh> views,
                                    std::span<const FaceVisibility> visibility, std::span<const glm::vec2> complements,
                                    std::span<const std::uint32_t> faces, const DifferenceOptions& options,
                                    int threads);

}  // namespace ibr
