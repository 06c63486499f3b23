#version 460
// SPDX-License-Identifier: Apache-2.0
// Corner of a hidden area, in a render pass of one view.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "render/hidden_area_corner.glsl"

void main() { gl_Position = cornerInClip(); }
