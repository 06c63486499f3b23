#version 460
// SPDX-License-Identifier: Apache-2.0
// Writes a gathered pixel's depth, weights and confidence: BufferTargets in ibr/target.h.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "render/gather.glsl"

layout(early_fragment_tests) in;
layout(location = 0) out vec4 outSurface;  // depth, tier, rank, extrapolation distance
layout(location = 1) out vec4 outWeights;
layout(location = 2) out vec2 outConfidence;  // spread, uncertainty

void main() {
  const Pixel pixel = gatheredPixel();
  if (pixel.tier < 0) discard;
  const float inverseDepth = pixel.rho / views[c.view].spacing;
  outSurface = vec4(1.0 / max(inverseDepth, 0.0), float(pixel.tier), -1.0, 0.0);
  outWeights = pixel.shares;
  outConfidence = vec2(sqrt(pixel.variance) / 255.0, pixel.sigma / views[c.view].spacing);
}
