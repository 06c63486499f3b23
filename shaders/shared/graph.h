// SPDX-License-Identifier: Apache-2.0
// Lines of the image graph over an image (ibr/graph_overlay.h).
#ifndef IBR_SHARED_GRAPH_H
#define IBR_SHARED_GRAPH_H

#include "shared/glsl.h"

IBR_SHARED_BEGIN

struct GraphConstants {
  mat3 toView;      // world axes to the view's
  vec3 shift;       // from the eye to the origin of the lines' coordinates, world axes
  vec4 lens;        // fx, fy, cx, cy, px
  vec2 size;        // of the image, px
  float fade;       // world units: lines fade where they are nearer than this
  float strength;   // opacity of the colour, 0 to 1
  float halfWidth;  // px
  vec3 colour;      // in the target's encoding
};

/// Returns the line's share of a pixel whose centre has this distance from the line's centre, px.
IBR_FUNCTION float lineShare(float pixels, float halfWidth) {
  return clamp(halfWidth + 0.5f - pixels, 0.0f, 1.0f);
}

IBR_SHARED_END

#endif
