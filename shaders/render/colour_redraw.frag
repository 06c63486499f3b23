#version 460
// SPDX-License-Identifier: Apache-2.0
// Applies a colour table by drawing the mesh again, as in the paper ([T] §2.5.3, 3). Writes the cell's mapped colour at
// pixels that were empty before the cell.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "render/cell_colour.glsl"
#include "shared/colour_map.h"

layout(set = kSetColour, binding = kBindingTables, scalar) readonly buffer Tables { uint tables[]; };
layout(set = kSetColour, binding = kBindingPicture) uniform sampler2D before;  // copy of the framebuffer

layout(location = 0) out vec4 outColour;

void main() {
  const uvec2 pixel = uvec2(gl_FragCoord.xy);
  const uvec3 entry = uint(kLevels) * cells[inCell].table + levelsOf(cellColour(pixel, 1.0));
  if (pixelState(texelFetch(before, ivec2(pixel), 0).a) != kPixelEmpty) discard;
  outColour = vec4(mappedColour(tables[entry.r], tables[entry.g], tables[entry.b]), kTier0Alpha);
}
