#version 460
// SPDX-License-Identifier: Apache-2.0
// Corner of a hidden area, in a render pass of both eyes. Corners of the other view are moved outside.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_multiview : require
#include "render/hidden_area_corner.glsl"

void main() { gl_Position = gl_ViewIndex != int(inCorner.z) ? vec4(2.0, 2.0, 0.0, 1.0) : cornerInClip(); }
