#version 460
// SPDX-License-Identifier: Apache-2.0
// Corner of a triangle with its barycentric coordinates. Fetches vertices from buffers, since an indexed vertex is a
// different corner in each of its triangles.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "render/cell_vertex.glsl"
#include "shared/overlay.h"

layout(constant_id = 10) const uint kOverlay = kOverlayWireframe;

layout(set = kSetMeshes, binding = 0, scalar) readonly buffer Vertices { float vertices[]; };  // q_0 …, ρ
layout(set = kSetMeshes, binding = 1, scalar) readonly buffer Indices { uint indices[]; };
layout(set = kSetMeshes, binding = 2, scalar) readonly buffer Uncertainties { float uncertainties[]; };  // of ρ
layout(push_constant, scalar) uniform Constants { OverlayConstants constants; };

layout(location = 6) out vec3 outCorner;
layout(location = 7) out vec2 outInverseDistance;  // ρ and its uncertainty

void main() {
  const uint vertex = indices[constants.firstIndex + gl_VertexIndex];
  uint at = constants.firstFloat + vertex * uint(3 * kMembers + 1);
  vec3 points[kMaxMembers];
  for (int i = 0; i < kMaxMembers; ++i) {
    points[i] = vec3(0.0);
    if (i >= kMembers) continue;
    points[i] = vec3(vertices[at], vertices[at + 1], vertices[at + 2]);
    at += 3;
  }
  const float inverseDistance = placeVertex(points, vertices[at], gl_InstanceIndex);
  const int corner = gl_VertexIndex % 3;
  outCorner = vec3(corner == 0, corner == 1, corner == 2);
  const bool isKnown = kOverlay == kOverlayConfidence;
  outInverseDistance = vec2(inverseDistance, isKnown ? uncertainties[constants.firstUncertainty + vertex] : 0.0);
}
