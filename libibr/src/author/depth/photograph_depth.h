// SPDX-License-Identifier: Apache-2.0
// Depth of a scene's photographs, at backdropSize or the size that it was matched at, with the evidence that the other
// photographs give. Of a panorama it is found face by face (panorama_depth.h), and ρ is along the ray.
//
//   depth     as it was matched (photograph_sweep.h); of a photograph that was not its points
//   evidence  confirmations c and contradictions v (depth_consistency.h)
//   kept      c >= 2, or c >= 1 and c > v, or no other photograph could have confirmed it, or sky; and that in
//             surfaces of kLeastSurface px at least, but for points
//   completed the rest from around (complete_depth.h), so that depth is known everywhere; consensus
//             a = (c + .25) / (c + v + .5), with c = 2 in the sky. Where depth was completed c is 0 and a is .1
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
inline constexpr int kLeastSurface = 30;          // px of a depth's picture of backdropSize
inline constexpr std::size_t kDepthSources = 10;  // photographs that are asked about one photograph's depth

/// A photograph's depth as it was matched, and its evidence.
struct PhotographDepth : MatchedDepth {
  std::uint32_t node = 0;
  bool sparse = false;  // the depth is that of points
  int finer = 1;        // about how many px of its picture lie along one of backdropSize's
};

/// The depth of one of the photographs' depthViews() as it was matched; nullopt where it was not.
using DepthMatches = std::function<std::optional<SweptDepth>(std::size_t view)>;

/// World points that a photograph sees.
using PhotographPoints = std::function<std::vector<glm::dvec3>(std::uint32_t node)>;

struct PhotographDepthOptions {
  DepthMatches matches;          // of every view
  PhotographPoints points = {};  // of a photograph without a match; empty: nothing is known of its depth
  double residualPx = 0;         // of the poses, px of the stored photographs
  JobRunner depths, evidence;    // run the jobs of both steps; empty: one after the other
};

/// Of all photographs, in their order. Does not depend on the order in which jobs are run. 8 bytes a pixel. Throws what
/// the runners throw.
std::vector<PhotographDepth> depthOfPhotographs(std::span<const Camera> photographs,
                                                const PhotographDepthOptions& options);

/// The depth as far as it is kept; kUnknownDepth elsewhere.
ImageF keptDepth(const PhotographDepth& depth);

/// Depth that is known everywhere. Four maps of one size.
struct CompletedDepth {
  DepthMaps maps;
  ImageF kept;  // of maps.inverseDepth what was not completed; kUnknownDepth elsewhere
  Image8 confirmations;
};

/// `colours`: RGB, of the map's size.
CompletedDepth completed(const PhotographDepth& depth, const Image8& colours);

/// Sets confirmations and consensus of a backdrop's vertices from the nearest pixel of their depth. `stored`: the
/// photograph's intrinsics, in whose px the matches are.
void addEvidence(MorphMesh& mesh, const Intrinsics& stored, const CompletedDepth& depth);

}  // namespace ibr
