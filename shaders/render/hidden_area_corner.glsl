// SPDX-License-Identifier: Apache-2.0
// Projects a corner of a view's hidden area to depth 0, nearer than everything.
#include "shared/hidden_area.h"

layout(push_constant, scalar) uniform Constants { HiddenAreaConstants constants; };

layout(location = 0) in vec3 inCorner;  // tangents right and up, index of the view

vec4 cornerInClip() {
  const vec4 toClip = constants.toClip[int(inCorner.z)];
  return vec4(toClip.xz * inCorner.xy + toClip.yw, 0.0, 1.0);
}
