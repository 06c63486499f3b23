// SPDX-License-Identifier: Apache-2.0
// The guiding floor ([T] §2.5.4): a grid where no photograph shows anything. Lengths are in line spacings.
#ifndef IBR_SHARED_FLOOR_H
#define IBR_SHARED_FLOOR_H

#include "shared/glsl.h"

IBR_SHARED_BEGIN

IBR_CONSTANT float kFloorLine = 0.03f;  // width of a line
IBR_CONSTANT float kFloorGrey = 0.6f;
IBR_CONSTANT float kFloorStrength = 0.7f;  // share of the grey in the middle of a line

struct FloorConstants {
  mat3 toPlane;      // pixel (x, y, 1) → direction across, up, along, not normalised
  float height;      // of the eye above the floor
  vec2 origin;       // position of the eye in the grid, 0 to 1
  float fadeRadius;  // distance from below the eye at which the grid has faded out; 0: no floor
};

/// Returns the integral of the lines from 0 to x; lines are centred on integers.
IBR_FUNCTION float floorIntegral(float x) {
  const float from = x + 0.5f * kFloorLine, whole = floor(from);
  return whole * kFloorLine + min(from - whole, kFloorLine);
}

/// Returns the share of [x − width/2, x + width/2] that lines cover.
IBR_FUNCTION float floorCover(float x, float width) {
  const float w = max(width, 1e-3f);
  return (floorIntegral(x + 0.5f * w) - floorIntegral(x - 0.5f * w)) / w;
}

/// Returns the share of the grid's grey at a pixel.
IBR_FUNCTION float floorShare(FloorConstants plane, vec2 pixel) {
  if (plane.fadeRadius <= 0.0f) return 0.0f;
  const vec3 ray = plane.toPlane * vec3(pixel.x, pixel.y, 1.0f);
  if (ray.y * plane.height >= 0.0f) return 0.0f;  // at or beyond the horizon
  const float scale = -plane.height / ray.y;
  const vec2 away = vec2(ray.x, ray.z) * scale;
  const float distance = sqrt(away.x * away.x + away.y * away.y);
  const float fade = clamp(1.0f - distance / plane.fadeRadius, 0.0f, 1.0f);
  if (fade <= 0.0f) return 0.0f;
  // Change of the grid position from pixel to pixel.
  const vec3 dx = plane.toPlane[0], dy = plane.toPlane[1];
  const vec2 alongX = (vec2(dx.x, dx.z) - vec2(ray.x, ray.z) * (dx.y / ray.y)) * scale;
  const vec2 alongY = (vec2(dy.x, dy.z) - vec2(ray.x, ray.z) * (dy.y / ray.y)) * scale;
  const float across = floorCover(plane.origin.x + away.x, abs(alongX.x) + abs(alongY.x));
  const float along = floorCover(plane.origin.y + away.y, abs(alongX.y) + abs(alongY.y));
  return kFloorStrength * fade * (1.0f - (1.0f - across) * (1.0f - along));
}

IBR_SHARED_END

#endif
