// SPDX-License-Identifier: Apache-2.0
// Depth of a scene's photographs with the evidence of the other photographs, at backdropSize or the matched size. Depth
// of a panorama is found face by face (panorama_depth.h); its ρ is along the ray.
//
//   depth     as matched (photograph_sweep.h); of an unmatched photograph: its points
//   evidence  confirmations c and contradictions v (depth_consistency.h)
//   kept      c >= 2, or c >= 1 and c > v, or no other photograph could have confirmed the depth, or sky. Kept surfaces
//             have kMinSurfacePx px at least; depth of points is exempt
//   completed elsewhere, from around (complete_depth.h), so that depth is known everywhere; consensus
//             a = (c + 0.25) / (c + v + 0.5), with c = 2 in the sky; where depth was completed, c is 0 and a is 0.1
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "author/depth/panorama_depth.h"
#include "author/depth/photograph_sweep.h"
#include "ibr/image.h"
#include "ibr/scene.h"
#include "image/depth_texture.h"

namespace ibr {

inline constexpr float kCompletedConsensus = 0.1f;
inline constexpr int kMinSurfacePx = 30;          // px of a depth map at backdropSize
inline constexpr std::size_t kDepthSources = 10;  // photographs compared with one photograph's depth

/// A photograph's matched depth, and its evidence.
struct PhotographDepth : MatchedDepth {
  std::uint32_t node = 0;
  bool sparse = false;  // the depth is that of points
  int finer = 1;        // px of the map along one px at backdropSize, rounded
};

/// Matched depth of one of the photographs' depthViews(); nullopt if matching failed.
using DepthMatches = std::function<std::optional<SweptDepth>(std::size_t view)>;

/// World points that a photograph sees.
using PhotographPoints = std::function<std::vector<glm::dvec3>(std::uint32_t node)>;

struct PhotographDepthOptions {
  DepthMatches matches;          // of every view
  PhotographPoints points = {};  // of a photograph without a match; empty: its depth is unknown
  double residualPx = 0;         // of the poses, px of the stored photographs
  JobRunner depths, evidence;    // run the jobs of the two steps; empty: serial
};

/// Depth of all photographs, in their order; does not depend on the order in which jobs run. Takes 8 bytes per pixel.
/// Throws what the runners throw.
std::vector<PhotographDepth> depthOfPhotographs(std::span<const Camera> photographs,
                                                const PhotographDepthOptions& options);

/// The depth that passes the rule above; kUnknownDepth elsewhere.
ImageF filteredDepth(const PhotographDepth& depth);

/// Depth that is known everywhere. All maps have the same size.
struct CompletedDepth {
  DepthMaps maps;
  ImageF kept;  // maps.inverseDepth where not completed; kUnknownDepth elsewhere
  Image8 confirmations;
};

/// Completes a photograph's depth. `colours`: RGB, of the map's size.
CompletedDepth completed(const PhotographDepth& depth, const Image8& colours);

/// Sets confirmations and consensus of a backdrop's vertices from the nearest pixel of their depth. `stored`: the
/// photograph's intrinsics; the matches are in px of the stored photograph.
void addEvidence(MorphMesh& mesh, const Intrinsics& stored, const CompletedDepth& depth);

}  // namespace ibr
