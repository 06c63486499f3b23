// SPDX-License-Identifier: Apache-2.0
// A corner of a triangle of the mesh, fetched: into the view, or into a camera's picture.
#include "shared/htm.h"

layout(set = 0, binding = kBindingHtmPositions, scalar) readonly buffer Positions {
  vec3 positions[];
};
layout(set = 0, binding = kBindingHtmTriangles, scalar) readonly buffer Triangles {
  uint triangles[];
};
layout(push_constant, scalar) uniform Frame {
  HtmFrame frame;
};

invariant gl_Position;  // depth is drawn first, then tested for equality
