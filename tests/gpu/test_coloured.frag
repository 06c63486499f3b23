// SPDX-License-Identifier: Apache-2.0
#version 460
layout(constant_id = 0) const float kBrightness = 1.0;
layout(location = 0) in vec3 colour;
layout(location = 0) out vec4 outColour;

void main() { outColour = vec4(kBrightness * colour, 1.0); }
