// SPDX-License-Identifier: Apache-2.0
// Depth of the photographs of a scene with what the others say of it: what is stored in a scene for the gather.
#pragma once

#include <span>
#include <vector>

#include "author/depth/depth_consistency.h"
#include "ibr/scene.h"
#include "image/depth_texture.h"

namespace ibr {

/// Depth maps as depthEvidence() takes them. `known`: one a camera, along its axis, of any size, kUnknownDepth where
/// nothing was matched; `cameras`: pinholes at their stored size; `residualPx`: median reprojection residual, px of the
/// stored photographs.
std::vector<ConsistentDepth> consistentDepths(std::span<const Camera> cameras, std::vector<ImageF> known,
                                              double residualPx);

/// Median of the cells' CellQuality::residualPx, px; 0 where none says.
double medianResidual(const Scene& scene);

/// a of each pixel: (c + .25) / (c + v + .5), .1 where nothing was matched.
ImageF consensusOf(const ImageF& known, const DepthEvidence& evidence);

/// Sets confirmations and consensus of a backdrop's vertices, each from the nearest pixel of the maps. `stored`: the
/// photograph's camera at its stored size.
void addEvidence(MorphMesh& mesh, const Camera& stored, const ImageF& known, const DepthEvidence& evidence);

}  // namespace ibr
