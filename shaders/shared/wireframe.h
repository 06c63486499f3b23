// SPDX-License-Identifier: Apache-2.0
// Triangle edges over the picture, in a heat colour of the cell's rank ([T] fig. 4): light yellow is the main cell, and
// the later a cell is drawn the colder it gets.
#ifndef IBR_SHARED_WIREFRAME_H
#define IBR_SHARED_WIREFRAME_H

#include "shared/glsl.h"

IBR_SHARED_BEGIN

IBR_CONSTANT int kSetMeshes = 2;  // descriptor set

struct WireframeConstants {
  uint firstIndex;  // of the step
  uint firstFloat;  // of the mesh's vertices
  float rank;       // of the step's cell, 0 best
  float ranks;      // how many there are
};

/// Share of an edge in a pixel whose centre is so many pixels from it: a line of a pixel and a half, half of it in each of
/// the two triangles that share the edge.
IBR_FUNCTION float edgeShare(float pixels) { return clamp(1.25f - pixels, 0.0f, 1.0f); }

/// From light yellow through orange and red to dark blue.
IBR_FUNCTION vec3 rankColour(float rank, float ranks) {
  const float heat = ranks > 1.0f ? 3.0f * clamp(rank / (ranks - 1.0f), 0.0f, 1.0f) : 0.0f;
  const vec3 yellow = vec3(1.0f, 0.98f, 0.6f), orange = vec3(1.0f, 0.55f, 0.1f), red = vec3(0.8f, 0.1f, 0.2f),
             blue = vec3(0.15f, 0.15f, 0.65f);
  const vec3 colour = yellow + clamp(heat, 0.0f, 1.0f) * (orange - yellow) +
                      clamp(heat - 1.0f, 0.0f, 1.0f) * (red - orange) + clamp(heat - 2.0f, 0.0f, 1.0f) * (blue - red);
  return colour;
}

IBR_SHARED_END

#endif
