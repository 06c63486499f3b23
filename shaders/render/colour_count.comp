#version 460
// SPDX-License-Identifier: Apache-2.0
// Counts the proxy's colours. A pixel belongs to the best cell that covers the pixel, its owner. Every other covering
// cell k adds its own colour to M[k] and the owner's colour to H[k][owner]. One mask selects pixels for both
// histograms, so they count the same pixels.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shared/cell.h"
#include "shared/colour_map.h"

layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = kBindingColourFrame, scalar) readonly buffer Frame { ColourFrame frame; };
layout(binding = kBindingCounters, scalar) buffer Counters { uint counters[]; };
layout(binding = kBindingColourNoise, scalar) readonly buffer Noise { uint noiseRank[]; };
layout(binding = kBindingPicture) uniform sampler2D proxy;  // one tile per cell

void main() {
  const uvec2 pixel = gl_GlobalInvocationID.xy, cell = pixel % uint(kNoiseSize);
  if (pixel.x >= frame.tileWidth || pixel.y >= frame.tileHeight) return;
  if (noiseRank[cell.y * uint(kNoiseSize) + cell.x] >= frame.kept) return;
  uint owner = frame.count;
  uvec3 ownLevels = uvec3(0u);
  for (uint k = 0u; k < frame.count; ++k) {
    const uvec2 tile = uvec2(k % frame.tileColumns, k / frame.tileColumns) * uvec2(frame.tileWidth, frame.tileHeight);
    const vec4 colour = texelFetch(proxy, ivec2(tile + pixel), 0);
    if (pixelState(colour.a) == kPixelEmpty) continue;
    const uvec3 levels = levelsOf(colour.rgb);
    if (owner == frame.count) {
      owner = k;
      ownLevels = levels;
      continue;
    }
    for (uint c = 0u; c < 3u; ++c) {
      atomicAdd(counters[modifyOffset(k) + c * uint(kLevels) + levels[c]], 1u);
      atomicAdd(counters[jointOffset(frame.count, k, owner) + c * uint(kLevels) + ownLevels[c]], 1u);
    }
  }
}
