#version 460
// SPDX-License-Identifier: Apache-2.0
// A corner of what a view never shows, nearer than everything. In a pass for both eyes what is the other's lies outside.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_multiview : require
#include "shared/hidden_area.h"

layout(constant_id = 0) const bool kBothEyes = false;

layout(push_constant, scalar) uniform Constants { HiddenAreaConstants constants; };

layout(location = 0) in vec3 inCorner;  // tangents right and up, and the view

void main() {
  const int view = int(inCorner.z);
  const vec4 toClip = constants.toClip[view];
  const vec2 position = toClip.xz * inCorner.xy + toClip.yw;
  gl_Position = kBothEyes && gl_ViewIndex != view ? vec4(2.0, 2.0, 0.0, 1.0) : vec4(position, 0.0, 1.0);
}
