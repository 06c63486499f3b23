#version 460
// SPDX-License-Identifier: Apache-2.0
// Canvas → target: background and guiding floor where nothing was drawn, and the transfer function that the target's
// format undoes.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shared/floor.h"

layout(constant_id = 0) const bool kEncodedByTarget = false;  // an SRGB format

layout(set = 0, binding = 0) uniform sampler2D canvas;
layout(set = 0, binding = 1) uniform sampler2D formerCanvas;  // the picture of the order before a switch
layout(set = 0, binding = 2) uniform sampler2D fill;          // half the canvas's size, filtered
layout(push_constant, scalar) uniform Constants {
  vec3 background;     // display-encoded
  uint keepTier;       // 1: alpha is the canvas's tier code, 0: alpha is 1
  vec2 fillExtent;     // texels of `fill` in use; 0: it is not read
  float formerWeight;  // 0: the former canvas is not read
  FloorConstants plane;
};

layout(location = 0) out vec4 outColour;

vec3 decode(vec3 encoded) {  // IEC 61966-2-1
  return mix(pow((encoded + 0.055) / 1.055, vec3(2.4)), encoded / 12.92, lessThanEqual(encoded, vec3(0.04045)));
}

const float kFilled = 63.0 / 255.0;  // tier code of tier 3

// What shows where a canvas is empty, and its tier code.
vec4 behind() {
  vec4 shown = vec4(background, 0.0);
  if (fillExtent.x > 0.0) {
    const vec2 at = clamp(0.5 * gl_FragCoord.xy, vec2(0.5), fillExtent - 0.5);
    const vec4 filled = textureLod(fill, at / vec2(textureSize(fill, 0)), 0.0);
    if (filled.a > 0.0) shown = vec4(filled.rgb, kFilled);
  }
  shown.rgb = mix(shown.rgb, vec3(kFloorGrey), floorShare(plane, gl_FragCoord.xy));
  return shown;
}

void main() {
  const ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 shown = texelFetch(canvas, pixel, 0);
  if (shown.a == 0.0) shown = behind();
  if (formerWeight > 0.0) {
    const vec4 former = texelFetch(formerCanvas, pixel, 0);
    shown.rgb = mix(shown.rgb, former.a > 0.0 ? former.rgb : behind().rgb, formerWeight);
  }
  outColour = vec4(kEncodedByTarget ? decode(shown.rgb) : shown.rgb, keepTier != 0 ? shown.a : 1.0);
}
