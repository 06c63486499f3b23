// SPDX-License-Identifier: Apache-2.0
// Tests photographs' depth maps against each other: counts confirmations and contradictions of a pixel's depth.
//
//   confirmed     the point lies within t of the surface in the other photograph's depth map
//   contradicted  the point lies in front of all of the 3×3 pixels around by more than 2 t, and the middle one of these
//                 pixels is itself confirmed
//   t             1 step + 0.4 % of ρ + the parallax of the reprojection residual
//
// Only photographs with a parallax of at least 1.5° at the point confirm or contradict. A far too large depth has a
// small parallax from everywhere. A photograph with a smaller parallax therefore counts as a usable source if it has a
// different, confirmed depth there.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "author/depth/depth_map.h"
#include "ibr/image.h"

namespace ibr {

/// A photograph's depth map with its expected accuracy.
struct ConsistentDepth {
  DepthMap map;           // known where matched; kUnknownDepth elsewhere: neither tests others nor is tested
  double step = 0;        // change of ρ for 1 px at half the photograph's size over the median spacing
  double residualPx = 0;  // median reprojection residual, px of the map
};

/// Counts by pixel, 0 to 255; one channel, of the map's size.
struct DepthEvidence {
  Image8 confirmations, contradictions;
  Image8 usableSources;  // photographs with enough parallax at the point, or with a different depth there
};

/// Evidence for each map, from at most `sources` other photographs, chosen by overlap at parallaxes near 6°. The result
/// does not depend on the number of threads. Precondition: pinholes; steps positive.
std::vector<DepthEvidence> depthEvidence(std::span<const ConsistentDepth> depths, std::size_t sources = 10,
                                         int threads = 1);

/// Calls job(0) … job(count − 1), each once; returns when all have finished, or throws.
using JobRunner = std::function<void(std::size_t count, const std::function<void(std::size_t)>& job)>;

/// The same, with jobs run by `run`, which is called kEvidenceRuns times with one job per map.
std::vector<DepthEvidence> depthEvidence(std::span<const ConsistentDepth> depths, std::size_t sources,
                                         const JobRunner& run);
inline constexpr std::size_t kEvidenceRuns = 3;

}  // namespace ibr
