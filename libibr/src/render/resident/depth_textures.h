// SPDX-License-Identifier: Apache-2.0
// Depth textures of photographs (Node::depthFile), from their source.
#pragma once

#include <cstdint>
#include <stop_token>

#include "ibr/gpu_scene.h"

namespace ibr {

/// Size of a depth texture: from the header of its file, or from the source. Throws as readDepth().
glm::ivec2 depthSize(const Scene& scene, std::uint32_t node, const TextureSource& source, const std::stop_token& stop);

/// `source` empty: reads the node's depthFile. Throws Error (io, cancelled; invalidInput for a texture of another
/// format than rg16f or with several levels), and what the source throws.
Texture readDepth(const Scene& scene, std::uint32_t node, const TextureSource& source, const std::stop_token& stop);

/// Returns a depth texture of 1/2^`level` of the sides, at least 1: each texel has the largest inverse distance of its
/// block, since the inverse distance decides occlusion, and the consensus of the same texel.
Texture reducedDepth(const Texture& depth, std::uint32_t level);

}  // namespace ibr
