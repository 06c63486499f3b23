#version 460
// SPDX-License-Identifier: Apache-2.0
// A cell's raw colour in its tile of the proxy: fewer pixels than the picture has, each as detailed as the picture's,
// because averages would lose the tails that the tables need.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "render/cell_colour.glsl"
#include "shared/colour_map.h"

layout(push_constant) uniform Tile {
  uvec2 origin;
  float detail;  // 1 / pixels of the picture between pixels of the proxy
};

layout(location = 0) out vec4 outColour;

void main() {
  const vec3 colour = cellColour(uvec2(gl_FragCoord.xy) - origin, detail);
  outColour = vec4(vec3(levelsOf(colour)) / 255.0, kTier0Alpha);
}
