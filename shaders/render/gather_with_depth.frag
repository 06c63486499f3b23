#version 460
// SPDX-License-Identifier: Apache-2.0
// As gather.frag, and writes the canvas's depth, for targets with a DepthTarget.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "render/gather.glsl"

layout(location = 0) out vec4 outColour;

void main() {
  const Pixel pixel = gatheredPixel();
  if (pixel.tier < 0) discard;
  outColour = canvasColour(pixel);
  gl_FragDepth = canvasDepth(pixel);
}
