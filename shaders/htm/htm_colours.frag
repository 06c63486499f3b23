#version 460
// SPDX-License-Identifier: Apache-2.0
// Interpolates vertex colours over a triangle; vertices without a colour (0, 0, 0, 0) do not count.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shared/htm.h"
#include "htm/htm_encode.glsl"

layout(push_constant, scalar) uniform Frame {
  HtmFrame frame;
};

layout(location = 0) in vec4 inColour;
layout(location = 0) out vec4 outColour;

void main() {
  outColour =
      inColour.w > 0.0 ? vec4(htmEncode(inColour.rgb / inColour.w), 1.0) : vec4(htmEncode(frame.background), 0.0);
}
