#version 460
// SPDX-License-Identifier: Apache-2.0
// Applies a colour table to all pixels, as in the paper ([T] §2.5.3, 3). Pending pixels go through the table of the
// cell that was drawn last, and become final.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shared/colour_map.h"

layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = kBindingTables, scalar) readonly buffer Tables { uint tables[]; };
layout(binding = kBindingCanvas, rgba8) uniform image2D canvas;

layout(push_constant) uniform Which {
  uvec2 extent;
  uint slot;
};

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(gl_GlobalInvocationID.xy, extent))) return;
  const vec4 colour = imageLoad(canvas, pixel);
  if (pixelState(colour.a) != kPixelPending) return;
  const uvec3 entry = uint(kLevels) * slot + levelsOf(colour.rgb);
  imageStore(canvas, pixel,
             vec4(mappedColour(tables[entry.r], tables[entry.g], tables[entry.b]), colour.a + kPendingStep));
}
