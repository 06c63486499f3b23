#version 460
// SPDX-License-Identifier: Apache-2.0
// A cell's colour in the canvas, through its colour table where colours are mapped.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "render/cell_colour.glsl"
#include "shared/colour_map.h"

layout(constant_id = 7) const bool kMapped = false;

layout(set = kSetFrame, binding = kBindingFrameTables, scalar) readonly buffer Tables { uint tables[]; };

layout(location = 0) out vec4 outColour;

void main() {
  vec3 colour = cellColour(uvec2(gl_FragCoord.xy), 1.0);
  if (kMapped) {
    const uvec3 entry = uint(kLevels) * cells[inCell].table + levelsOf(colour);
    colour = mappedColour(tables[entry.r], tables[entry.g], tables[entry.b]);
  }
  outColour = vec4(colour, cells[inCell].alpha);
}
