// SPDX-License-Identifier: Apache-2.0
// Lines of the image graph over a picture (ibr/graph_overlay.h).
#ifndef IBR_SHARED_GRAPH_H
#define IBR_SHARED_GRAPH_H

#include "shared/glsl.h"

IBR_SHARED_BEGIN

struct GraphConstants {
  mat3 toView;      // world axes to the view's
  vec3 shift;       // from the eye to where the lines' coordinates start, world axes
  vec4 lens;        // fx, fy, cx, cy, px
  vec2 size;        // of the picture, px
  float fade;       // world units: lines fade where they come nearer than this
  float strength;   // of the colour, 0 to 1
  float halfWidth;  // px
  vec3 colour;      // as the target takes it
};

/// Share of a pixel whose middle is so many pixels from a line's.
IBR_FUNCTION float lineShare(float pixels, float halfWidth) {
  return clamp(halfWidth + 0.5f - pixels, 0.0f, 1.0f);
}

IBR_SHARED_END

#endif
