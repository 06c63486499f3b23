#version 460
// SPDX-License-Identifier: Apache-2.0
// Counts histograms as in the paper ([T] §2.5.3, 1). If the framebuffer has a colour at the pixel, that colour and the
// cell's colour are counted: the same pixels in both histograms. An empty pixel gets the cell's colour and is pending
// until a table is applied.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "render/cell_colour.glsl"
#include "shared/colour_map.h"

layout(set = kSetColour, binding = kBindingColourFrame, scalar) readonly buffer Frame { ColourFrame frame; };
layout(set = kSetColour, binding = kBindingCounters, scalar) buffer Counters { uint counters[]; };
layout(set = kSetColour, binding = kBindingPicture) uniform sampler2D before;  // copy of the framebuffer

layout(push_constant) uniform Which { uint cell; };

layout(location = 0) out vec4 outColour;

void main() {
  const uvec2 pixel = uvec2(gl_FragCoord.xy), tile = pixel % uint(kNoiseSize);
  const uvec3 levels = levelsOf(cellColour(pixel, 1.0));
  const vec4 there = texelFetch(before, ivec2(pixel), 0);
  if (pixelState(there.a) != kPixelEmpty) {
    if (noiseRank[tile.y * uint(kNoiseSize) + tile.x] < frame.kept) {
      const uvec3 reference = levelsOf(there.rgb);
      for (uint c = 0u; c < 3u; ++c) {
        atomicAdd(counters[modifyOffset(cell) + c * uint(kLevels) + levels[c]], 1u);
        atomicAdd(counters[referenceOffset(frame.count, cell) + c * uint(kLevels) + reference[c]], 1u);
      }
    }
    discard;
  }
  outColour = vec4(vec3(levels) / 255.0, kTier0Alpha - kPendingStep);
}
