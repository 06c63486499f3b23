// SPDX-License-Identifier: Apache-2.0
// Colour of a cell, mapped through its colour table if kMapped.
#include "render/cell_colour.glsl"
#include "shared/colour_map.h"

layout(constant_id = 7) const bool kMapped = false;

layout(set = kSetFrame, binding = kBindingFrameTables, scalar) readonly buffer Tables { uint tables[]; };

vec3 mappedCellColour() {
  const vec3 colour = cellColour(uvec2(gl_FragCoord.xy), 1.0);
  if (!kMapped) return colour;
  const uvec3 entry = uint(kLevels) * cells[inCell].table + levelsOf(colour);
  return mappedColour(tables[entry.r], tables[entry.g], tables[entry.b]);
}
