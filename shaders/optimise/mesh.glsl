// SPDX-License-Identifier: Apache-2.0
// Buffers of the mesh that is being aligned (shared/alignment.h).
#include "shared/alignment.h"

#ifdef POSITIONS_ARE_READ
#define POSITION_ACCESS readonly
#else
#define POSITION_ACCESS
#endif

layout(binding = kBindingAlignment, scalar) readonly buffer Mesh { AlignmentMesh mesh; };
layout(binding = kBindingPositions, scalar) POSITION_ACCESS buffer Positions { ivec2 positions[]; };
layout(binding = kBindingStarts, scalar) readonly buffer Starts { ivec2 starts[]; };
layout(binding = kBindingStarFirst, scalar) readonly buffer StarFirst { uint starFirst[]; };
layout(binding = kBindingStarEdges, scalar) readonly buffer StarEdges { uvec2 starEdges[]; };

ivec2 positionIn(uint member, uint point) { return positions[member * mesh.points + point]; }

ivec2 sumOfPositions(uint point) {
  ivec2 sum = ivec2(0);
  for (uint i = 0u; i < mesh.members; ++i) sum += positionIn(i, point);
  return sum;
}

/// Returns the vector from the point's initial match to the candidate.
ivec2 displacementOf(uint member, uint point, ivec2 offset) {
  return positionIn(member, point) + offset - starts[member * mesh.points + point];
}
