// SPDX-License-Identifier: Apache-2.0
// Buffers from which a vertex stage fetches the corners of the mesh's triangles, for the view or a camera's image.
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

invariant gl_Position;  // a depth pass comes first; the colour pass tests for equality
