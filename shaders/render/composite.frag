#version 460
// SPDX-License-Identifier: Apache-2.0
// Composes the canvas into the target: background and floor where nothing is drawn, and the transfer function for the
// target's format and encoding. Constants disable unused inputs: some devices (lavapipe) execute both sides of every
// branch.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shared/floor.h"
#include "shared/hidden_area.h"

layout(constant_id = 0) const bool kLinear = false;    // the target takes linear light, also to encode it itself
layout(constant_id = 1) const bool kPrevious = false;  // two draw orders are cross-faded
layout(constant_id = 2) const bool kFill = false;
layout(constant_id = 3) const bool kScaled = false;  // the image in the canvas has another size than the target
layout(constant_id = 4) const bool kFloor = false;
layout(constant_id = 5) const bool kHidden = false;  // there is a hidden area

layout(set = 0, binding = 0) uniform sampler2D canvas;
layout(set = 0, binding = 1) uniform sampler2D previousCanvas;  // image of the previous draw order
layout(set = 0, binding = 2) uniform sampler2D fill;          // half the canvas's size, linear filter
layout(push_constant, scalar) uniform Constants {
  vec3 background;     // display-encoded
  uint keepTier;       // 1: alpha is the canvas's tier code, 0: alpha is 1
  vec2 fillExtent;     // texels of `fill` in use
  vec2 canvasExtent;   // texels of the canvas in use
  vec2 targetExtent;
  float previousWeight;
  FloorConstants plane;
};

layout(location = 0) out vec4 outColour;

vec3 decode(vec3 encoded) {  // IEC 61966-2-1
  return mix(pow((encoded + 0.055) / 1.055, vec3(2.4)), encoded / 12.92, lessThanEqual(encoded, vec3(0.04045)));
}

const float kFilled = 63.0 / 255.0;  // tier code of tier 3

// Returns the colour behind the canvas's empty pixels, and its tier code. `at`: px of the canvas.
vec4 behind(vec2 at) {
  vec4 shown = vec4(background, 0.0);
  if (kFill) {
    const vec2 inside = clamp(0.5 * at, vec2(0.5), fillExtent - 0.5);
    const vec4 filled = textureLod(fill, inside / vec2(textureSize(fill, 0)), 0.0);
    if (filled.a > 0.0) shown = vec4(filled.rgb, kFilled);
  }
  if (kFloor) shown.rgb = mix(shown.rgb, vec3(kFloorGrey), floorShare(plane, gl_FragCoord.xy));
  return shown;
}

vec4 texel(sampler2D image, ivec2 pixel, vec4 back) {
  const vec4 drawn = texelFetch(image, pixel, 0);
  return drawn.a == 0.0 ? back : drawn;
}

// Cross-fades both images. A pixel that is empty in the previous image shows the current one alone.
vec4 shownAt(ivec2 pixel, vec4 back) {
  const vec4 now = texel(canvas, pixel, back);
  return kPrevious ? vec4(mix(now.rgb, texel(previousCanvas, pixel, now).rgb, previousWeight), now.a) : now;
}

// Interpolates colours, also of empty pixels in between, but not of hidden ones. The tier code is that of the nearest
// pixel.
vec4 picture(vec2 at, vec4 back) {
  if (kHidden && isHidden(texelFetch(canvas, ivec2(at), 0).a)) return vec4(background, 0.0);
  vec4 shown = shownAt(ivec2(at), back);
  if (kScaled) {
    const ivec2 low = ivec2(floor(at - 0.5)), last = ivec2(canvasExtent) - 1;
    const vec2 share = fract(at - 0.5);
    vec3 sum = vec3(0.0);
    for (int y = 0; y < 2; ++y)
      for (int x = 0; x < 2; ++x) {
        const float weight = (x == 0 ? 1.0 - share.x : share.x) * (y == 0 ? 1.0 - share.y : share.y);
        const ivec2 pixel = clamp(low + ivec2(x, y), ivec2(0), last);
        const bool hidden = kHidden && isHidden(texelFetch(canvas, pixel, 0).a);
        sum += weight * (hidden ? shown.rgb : shownAt(pixel, back).rgb);
      }
    shown.rgb = sum;
  }
  return shown;
}

void main() {
  const vec2 at = kScaled ? gl_FragCoord.xy * (canvasExtent / targetExtent) : gl_FragCoord.xy;
  const vec4 shown = picture(at, behind(at));
  outColour = vec4(kLinear ? decode(shown.rgb) : shown.rgb, keepTier != 0 ? shown.a : 1.0);
}
