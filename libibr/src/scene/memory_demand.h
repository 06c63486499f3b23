// SPDX-License-Identifier: Apache-2.0
// What a scene takes on a device ([T] §2.6.3, eqs 19–21), without loading it.
//
// Departures from eq. 21, all as the renderer stores a scene: a photograph counts once, however many cells show it, and
// not at all if none does (the paper counts it once a cell; NUMERICS T25); a position is not a coordinate pair a member
// but three floats a member and one for ρ; textures may be RGBA8 or BC7 as well (eq. 19's 6:1 is BC1), and mip levels
// are summed as they are, where eq. 20 takes their limit of 4/3. Depth textures come in addition, whole.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ibr/scene.h"
#include "ibr/texture.h"

namespace ibr {

struct MemoryDemand {
  std::uint64_t positions = 0, indices = 0, textures = 0, depth = 0;  // bytes
  std::uint64_t sum() const { return positions + indices + textures + depth; }
};

/// `formats`: of the nodes' textures on the device. `depth`: bytes of the depth textures (depthTextureBytes), 0 where
/// they are not loaded. Exact but for what a device adds to align images and buffers, and
/// for triangles that the renderer leaves out since their members look in opposite directions (T10).
MemoryDemand memoryDemand(const Scene& scene, std::span<const TextureFormat> formats, std::uint64_t depth = 0);

/// Of the nodes' texture files, one a node; RGBA8 where a node has none. Throws as probeKtx2.
std::vector<TextureFormat> textureFormats(const Scene& scene);

/// Of all nodes that have a depth file. Throws as probeKtx2.
std::uint64_t depthTextureBytes(const Scene& scene);

}  // namespace ibr
