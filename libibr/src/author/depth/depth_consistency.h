// SPDX-License-Identifier: Apache-2.0
// What photographs say of each other's depth: how many confirm a pixel's depth, and how many see past it.
//
//   confirmed     the point lies within t of the surface that the other photograph sees there
//   contradicted  the point stands before all of the 3×3 pixels around by more than 2 t, and the middle one of these is
//                 itself confirmed
//   t             1 step + .4 % of ρ + the parallax of the reprojection residual
//
// Only photographs that see the point from at least 1.5° apart count. A depth that is far too large is seen so by none:
// what tells against it are photographs that see something else there.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "author/depth/depth_map.h"
#include "ibr/image.h"

namespace ibr {

/// A photograph's depth map with the accuracy that is expected of it.
struct ConsistentDepth {
  DepthMap map;           // known where matched; kUnknownDepth elsewhere, which neither asks nor answers
  double step = 0;        // ρ that moves a point by 1 px at half the photograph's size over the median spacing
  double residualPx = 0;  // median reprojection residual, px of the map
};

/// Counts by pixel, 0 to 255; one channel, of the map's size.
struct DepthEvidence {
  Image8 confirmations, contradictions;
  Image8 witnesses;  // photographs that see the point from far enough apart, or something else there
};

/// Evidence for each map. At most `sources` other photographs are asked, chosen by how much they see at parallaxes near
/// 6°. The result does not depend on the number of threads. Precondition: pinholes; steps positive.
std::vector<DepthEvidence> depthEvidence(std::span<const ConsistentDepth> depths, std::size_t sources = 10,
                                         int threads = 1);

/// Calls job(0) … job(count − 1), each once; returns when all are done, or throws.
using JobRunner = std::function<void(std::size_t count, const std::function<void(std::size_t)>& job)>;

/// The same with jobs run by `run`, which is called kEvidenceRuns times with a job a map.
std::vector<DepthEvidence> depthEvidence(std::span<const ConsistentDepth> depths, std::size_t sources,
                                         const JobRunner& run);
inline constexpr std::size_t kEvidenceRuns = 3;

}  // namespace ibr
