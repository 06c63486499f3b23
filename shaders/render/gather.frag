#version 460
// SPDX-License-Identifier: Apache-2.0
// Gathers the colour of a pixel that no cell covers.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "render/gather.glsl"

layout(early_fragment_tests) in;  // covered pixels cost nothing
layout(location = 0) out vec4 outColour;

void main() {
  const Pixel pixel = gatheredPixel();
  if (pixel.tier < 0) discard;
  outColour = canvasColour(pixel);
}
