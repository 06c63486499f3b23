// SPDX-License-Identifier: Apache-2.0
// Depth of a photograph and the consensus about it as a texture (Node::depthFile).
#pragma once

#include "ibr/image.h"
#include "ibr/texture.h"

namespace ibr {

struct DepthTexture {
  Texture texture;   // rg16f, one level: ρ / scale, consensus
  double scale = 1;  // the largest ρ; 1 where all is at infinity
};

/// Two maps of one size, one channel each, that cover a photograph of `photographWidth` px: ρ >= 0, consensus 0 to 1.
/// They are reduced to about a quarter of the photograph's sides, never enlarged: of each block the largest ρ and its
/// consensus.
DepthTexture depthTexture(const ImageF& inverseDepth, const ImageF& consensus, int photographWidth);

struct DepthMaps {
  ImageF inverseDepth, consensus;
};
/// The inverse. Throws Error{invalidInput} unless it is rg16f with one level.
DepthMaps depthMaps(const Texture& texture, double scale);

}  // namespace ibr
