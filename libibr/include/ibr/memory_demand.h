// SPDX-License-Identifier: Apache-2.0
// Memory of a scene on a device ([T] §2.6.3, eqs 19–21), computed without loading the scene.
//
// Departures from eq. 21, all as the renderer stores a scene. A photograph counts once, however many cells show it, and
// not at all if none does (the paper counts it per cell). A position is three floats per member and one for ρ, not a
// coordinate pair per member. Textures may also be RGBA8 or BC7 (eq. 19's 6:1 is BC1). Mip levels are summed exactly,
// while eq. 20 takes the limit 4/3. Depth textures are added in full.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ibr/export.h"
#include "ibr/scene.h"
#include "ibr/texture.h"

namespace ibr {

/// Device memory of a scene, bytes.
struct MemoryDemand {
  // positions: vertices of meshes; indices: triangles of meshes; textures: photographs; depth: depth textures
  std::uint64_t positions = 0, indices = 0, textures = 0, depth = 0;
  std::uint64_t sum() const { return positions + indices + textures + depth; }  // all bytes
};

/// Returns the device memory of a scene. `formats`: of the nodes' textures on the device. `depth`: bytes of the depth
/// textures (depthTextureBytes), 0 if they are not loaded. Exact, except for the device's alignment of images and
/// buffers, and for triangles that the renderer drops because their members look in opposite directions.
IBR_API MemoryDemand memoryDemand(const Scene& scene, std::span<const TextureFormat> formats, std::uint64_t depth = 0);

/// Returns the formats of the nodes' texture files, one per node; RGBA8 for a node without one. Throws as probeKtx2.
IBR_API std::vector<TextureFormat> textureFormats(const Scene& scene);

/// Returns the bytes of all depth textures. Throws as probeKtx2.
IBR_API std::uint64_t depthTextureBytes(const Scene& scene);

}  // namespace ibr
