#version 460
// SPDX-License-Identifier: Apache-2.0
#extension GL_GOOGLE_include_directive : require
#include "shared/hidden_area.h"

layout(location = 0) out vec4 outColour;

void main() { outColour = vec4(0.0, 0.0, 0.0, kHiddenAlpha); }
