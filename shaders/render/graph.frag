#version 460
// SPDX-License-Identifier: Apache-2.0
// Draws a line of the image graph with antialiasing.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shared/graph.h"

layout(location = 0) in float inAcross;
layout(location = 1) in float inFade;
layout(push_constant, scalar) uniform Constants { GraphConstants constants; };

layout(location = 0) out vec4 outColour;

void main() {
  const float share = lineShare(abs(inAcross), constants.halfWidth);
  outColour = vec4(constants.colour, inFade * constants.strength * share);
}
