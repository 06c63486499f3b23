#version 460
// SPDX-License-Identifier: Apache-2.0
// Writes a cell's colour into the canvas.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "render/cell_mapped.glsl"

layout(location = 0) out vec4 outColour;

void main() { outColour = vec4(mappedCellColour(), kTier0Alpha); }
