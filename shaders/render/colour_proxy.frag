#version 460
// SPDX-License-Identifier: Apache-2.0
// Writes a cell's raw colour into its tile of the proxy. The proxy has fewer pixels than the image, each with the
// image's detail: averages would lose the tails of the histograms that the tables need.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "render/cell_colour.glsl"
#include "shared/colour_map.h"

layout(push_constant) uniform Tile {
  uvec2 origin;
  float detail;  // 1 / distance of the proxy's pixels, px of the image
};

layout(location = 0) out vec4 outColour;

void main() {
  const vec3 colour = cellColour(uvec2(gl_FragCoord.xy) - origin, detail);
  outColour = vec4(vec3(levelsOf(colour)) / 255.0, kTier0Alpha);
}
