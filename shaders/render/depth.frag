#version 460
// SPDX-License-Identifier: Apache-2.0
// Canvas depth → the caller's: rank and depth inside a mesh are told apart (render/passes/cell_pass.h), and the inverse distance
// goes through the caller's projection, which is linear in it: depth = offset + slope / z.
#extension GL_GOOGLE_include_directive : require
#include "shared/hidden_area.h"

layout(constant_id = 0) const bool kHidden = false;  // there is a hidden area, which is far

layout(set = 0, binding = 0) uniform sampler2D canvasDepth;
layout(set = 0, binding = 1) uniform sampler2D canvas;
layout(push_constant) uniform Constants {
  float slots;         // steps + 1
  float stepDepth;     // share of a slot that a step uses
  float nearDistance;  // of the plan
  float offset;
  float slope;
  float scaleX;  // canvas's pixels to one of the target
  float scaleY;
};

void main() {
  const ivec2 at = ivec2(gl_FragCoord.xy * vec2(scaleX, scaleY));
  float value = texelFetch(canvasDepth, at, 0).r;
  if (kHidden && isHidden(texelFetch(canvas, at, 0).a)) value = 1.0;
  float inside = fract(value * slots);
  // In the gap between two steps: rounded down from the next one's nearest.
  if (inside > 0.5 * (1.0 + stepDepth)) inside = 0.0;
  const float inverseDistance = value >= 1.0 ? 0.0 : max(1.0 - inside / stepDepth, 0.0) / nearDistance;
  gl_FragDepth = clamp(offset + slope * inverseDistance, 0.0, 1.0);
}
