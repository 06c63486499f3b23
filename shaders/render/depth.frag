#version 460
// SPDX-License-Identifier: Apache-2.0
// Converts canvas depth to the caller's depth. Rank and depth inside a mesh are separated (render/passes/cell_pass.h).
// The caller's projection is linear in the inverse distance: depth = offset + slope / z.
#extension GL_GOOGLE_include_directive : require
#include "shared/hidden_area.h"

layout(constant_id = 0) const bool kHidden = false;  // there is a hidden area, whose depth is far

layout(set = 0, binding = 0) uniform sampler2D canvasDepth;
layout(set = 0, binding = 1) uniform sampler2D canvas;
layout(push_constant) uniform Constants {
  float slots;         // draw items + 1
  float stepDepth;     // share of a slot that an item uses
  float nearDistance;  // of the plan
  float offset;
  float slope;
  float scaleX;  // pixels of the canvas per pixel of the target
  float scaleY;
};

void main() {
  const ivec2 at = ivec2(gl_FragCoord.xy * vec2(scaleX, scaleY));
  float value = texelFetch(canvasDepth, at, 0).r;
  if (kHidden && isHidden(texelFetch(canvas, at, 0).a)) value = 1.0;
  float inside = fract(value * slots);
  // A value in the gap between two items is the next item's nearest depth, rounded down.
  if (inside > 0.5 * (1.0 + stepDepth)) inside = 0.0;
  const float inverseDistance = value >= 1.0 ? 0.0 : max(1.0 - inside / stepDepth, 0.0) / nearDistance;
  gl_FragDepth = clamp(offset + slope * inverseDistance, 0.0, 1.0);
}
