#version 460
// SPDX-License-Identifier: Apache-2.0
// A cell's colour, and its triangles' edges in the colour of its rank ([T] fig. 4).
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "render/cell_mapped.glsl"
#include "shared/wireframe.h"

layout(location = 6) in vec3 inCorner;  // barycentric coordinates
layout(push_constant, scalar) uniform Constants { WireframeConstants constants; };

layout(location = 0) out vec4 outColour;

void main() {
  const vec3 slope = sqrt(dFdx(inCorner) * dFdx(inCorner) + dFdy(inCorner) * dFdy(inCorner));
  const vec3 pixels = inCorner / max(slope, 1e-9);  // to each edge
  const vec3 colour = mappedCellColour();
  const float edge = edgeShare(min(pixels.x, min(pixels.y, pixels.z)));
  outColour = vec4(mix(colour, rankColour(constants.rank, constants.ranks), edge), cells[inCell].alpha);
}
