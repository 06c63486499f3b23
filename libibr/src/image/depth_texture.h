// SPDX-License-Identifier: Apache-2.0
// Depth textures (Node::depthFile): ρ and consensus of a photograph at about a quarter of its width and height, two
// half floats per texel.
#pragma once

#include <glm/vec2.hpp>

#include "ibr/image.h"
#include "ibr/texture.h"

namespace ibr {

struct DepthTexture {
  Texture texture;   // TextureFormat::rg16f, one level
  double scale = 1;  // Node::depthScale: the largest ρ of the maps; 1 if everything is at infinity
};

/// Side, in map pixels, of the block that becomes one texel: a texel is about 4 px of the photograph; at least 1.
int depthBlockSide(int mapWidth, int photographWidth);

/// Size in texels of a depth texture made from maps of size mapSize.
glm::ivec2 depthTextureSize(glm::ivec2 mapSize, int photographWidth);

/// Each texel has the largest ρ of its block, since ρ decides occlusion, and the consensus of the same pixel (the first
/// in row order among equals). Rounds to the nearest half float, ties to even. Throws Error{invalidInput} for maps that
/// are empty, of different sizes, not finite, or out of range.
DepthTexture depthTexture(const DepthMaps& maps, int photographWidth);

}  // namespace ibr
