// SPDX-License-Identifier: Apache-2.0
// Morphs a vertex ([T] §2.5.1 eq. 4), for all vertex stages of cells:
//   D = Σ λ_i R_i q_i + ρ t,  q_i = a_i r_i,  t = Σ λ_i c_i − p
// A pinhole projects q_i to a homogeneous texture coordinate; a panorama passes q_i on unchanged ([T] fig. 1). Both
// share the vertex's scale with (D, ρ), so perspective interpolation is exact inside a triangle.
// (D, ρ) is the vertex in homogeneous coordinates of the virtual camera, so ρ = 0 is infinity.
#include "shared/cell.h"

layout(constant_id = 0) const int kMembers = 4;
layout(constant_id = 3) const int kPanoramas = 0;  // bit i: member i is a panorama

layout(set = kSetFrame, binding = kBindingParameters, scalar) readonly buffer Parameters { CellParameters cells[]; };

layout(location = 0) out vec3 outTexture[kMaxMembers];  // homogeneous texture coordinate in member i; panorama: q_i
layout(location = 4) flat out uint outCell;
layout(location = 5) flat out float outDetail;

/// `points`: q_i; entries beyond kMembers are ignored. Returns ρ with which the vertex is drawn.
float placeVertex(vec3 points[kMaxMembers], float storedInverseDistance, uint cell) {
  const bool unitRays = cells[cell].unitRays != 0;
  const float inverseDistance = unitRays ? 0.0 : storedInverseDistance;
  vec3 direction = inverseDistance * cells[cell].shift;
  for (int i = 0; i < kMembers; ++i) {
    const vec3 point = unitRays ? normalize(points[i]) : points[i];
    direction += cells[cell].member[i].position * (cells[cell].member[i].toView * point);
    const vec2 focal = cells[cell].member[i].focal, principal = cells[cell].member[i].principal;
    outTexture[i] = (kPanoramas >> i & 1) != 0 ? point
                                               : vec3(focal.x * point.x - principal.x * point.z,
                                                      -focal.y * point.y - principal.y * point.z, -point.z);
  }
  for (int i = kMembers; i < kMaxMembers; ++i) outTexture[i] = vec3(0.0);
  outCell = cell;
  outDetail = cells[cell].detail;
  const vec4 projection = cells[cell].projection;
  gl_Position = vec4(projection.x * direction.x - projection.y * direction.z,
                     projection.z * direction.y - projection.w * direction.z,
                     -direction.z - cells[cell].nearDistance * inverseDistance, -direction.z);
  return inverseDistance;
}
