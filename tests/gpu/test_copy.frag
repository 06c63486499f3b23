// SPDX-License-Identifier: Apache-2.0
#version 460
layout(set = 0, binding = 0) uniform sampler2D source;
layout(location = 0) out vec4 outColour;

void main() { outColour = texelFetch(source, ivec2(gl_FragCoord.xy), 0); }
