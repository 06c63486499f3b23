#version 460
// SPDX-License-Identifier: Apache-2.0
// Draws an overlay over, or in place of, a gathered pixel's colour (shared/overlay.h).
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "render/gather.glsl"
#include "shared/overlay.h"

layout(constant_id = 9) const uint kOverlay = kOverlayTiers;

layout(location = 0) out vec4 outColour;

vec3 colourOf(Pixel pixel) {
  if (kOverlay == kOverlayTiers) return tinted(tierColour(uint(pixel.tier)), pixel.colour);
  if (kOverlay == kOverlayDepth) return depthColour(pixel.rho, views[c.view].nearDistance);
  if (kOverlay == kOverlayConfidence) return confidenceColour(pixel.rho, pixel.sigma);
  if (kOverlay == kOverlayAgreement) return unknownColour();
  if (kOverlay != kOverlayWeights) return pixel.colour;  // the wireframe shows cells alone
  vec3 shares = vec3(0.0);
  for (int i = 0; i < 4; ++i) shares += pixel.shares[i] * memberColour(i);
  return tinted(shares, pixel.colour);
}

void main() {
  const Pixel pixel = gatheredPixel();
  if (pixel.tier < 0) discard;
  outColour = vec4(colourOf(pixel), canvasColour(pixel).a);
  gl_FragDepth = canvasDepth(pixel);
}
