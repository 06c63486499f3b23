// SPDX-License-Identifier: Apache-2.0
// Equirectangular panoramas ([T] §2.5.1, fig. 1; axes of ibr/conventions.h), for GLSL and C++.
//
// Departures from [T] eq. 5: longitude starts behind the camera, so that forward is in the middle of the image, and
// the zenith is +y. Angle functions are implemented here: a driver's may be wrong by 1.5e-3 rad (2 px of 8192).
#ifndef IBR_SHARED_PANORAMA_H
#define IBR_SHARED_PANORAMA_H

#include "shared/glsl.h"

IBR_SHARED_BEGIN

IBR_CONSTANT float kHalfPi = 1.57079633f;
IBR_CONSTANT float kMaxPanoramaReach = 8.0f;

/// Returns atan2(y, x), accurate to 3e-7 rad; 0 for (0, 0).
IBR_FUNCTION float angleOf(float y, float x) {
  const float across = abs(x), up = abs(y);
  const float low = min(across, up), high = max(across, up);
  if (high == 0.0f) return 0.0f;
  // Beyond π/8, atan(low / high) = π/4 + atan((low − high) / (low + high)): both quotients stay below tan(π/8).
  const bool wide = low > 0.41421356f * high;
  const float t = wide ? (low - high) / (low + high) : low / high, s = t * t;
  float angle = t + t * s * (-0.33332756f + s * (0.19971879f + s * (-0.13824446f + s * 0.07902577f)));
  if (wide) angle += 0.5f * kHalfPi;
  if (up > across) angle = kHalfPi - angle;
  if (x < 0.0f) angle = 2.0f * kHalfPi - angle;
  return y < 0.0f ? -angle : angle;
}

/// Returns the texture coordinate (0 to 1, v down) of a direction of any length.
IBR_FUNCTION vec2 panoramaCoordinate(vec3 direction) {
  const float across = sqrt(direction.x * direction.x + direction.z * direction.z);
  return vec2(angleOf(direction.x, -direction.z) / (4.0f * kHalfPi) + 0.5f,
              0.5f - angleOf(direction.y, across) / (2.0f * kHalfPi));
}

/// Samples of a panorama for one pixel: the weighted mean of taps at u + k·spacing. The middle tap has weight 1, each
/// tap ±k has weight clamp(reach − k + 1, 0, 1): a box filter of continuously varying width.
struct PanoramaFootprint {
  float texels;   // size of the pixel in texels of the equator; selects the mip level
  float spacing;  // texture coordinate
  float reach;    // 0 to kMaxPanoramaReach; 0: one tap
};

/// `ray`: unit. `dx`, `dy`: its differences to the neighbouring pixels. `size`: of the panorama, texels.
///
/// Differences of texture coordinates are not used: u jumps at the seam, and turns around a pole within one pixel.
/// Differences of rays are smooth, and give the same level of detail everywhere on the sphere. Near a pole, texels are
/// dense along u: a pixel is wider there than the filter of its mip level, and needs several taps.
IBR_FUNCTION PanoramaFootprint panoramaFootprint(vec3 ray, vec3 dx, vec3 dy, vec2 size) {
  const float across = sqrt(ray.x * ray.x + ray.z * ray.z);  // cosine of the latitude
  const bool pole = across < 1e-15f;                         // any longitude is valid at the pole
  const float sine = pole ? 0.0f : ray.x / across, cosine = pole ? 1.0f : -ray.z / across;  // of the longitude
  const float perEast = size.x / (4.0f * kHalfPi), perNorth = size.y / (2.0f * kHalfPi);
  const float eastX = perEast * (cosine * dx.x + sine * dx.z), eastY = perEast * (cosine * dy.x + sine * dy.z);
  const float northX = perNorth * (across * dx.y - ray.y * (sine * dx.x - cosine * dx.z));
  const float northY = perNorth * (across * dy.y - ray.y * (sine * dy.x - cosine * dy.z));
  PanoramaFootprint result;
  result.texels = sqrt(max(eastX * eastX + northX * northX, eastY * eastY + northY * northY));
  // The mip level's filter connects taps at this distance (in texels) without gaps; a single tap covers one and a half
  // pixels.
  const float apart = max(result.texels, 1.0f);
  const float width = min(sqrt(eastX * eastX + eastY * eastY) / max(across, 1e-6f), size.x);
  const float wanted = 0.5f * max(width / apart - 1.5f, 0.0f);
  result.reach = min(wanted, kMaxPanoramaReach);
  result.spacing = apart / size.x * max(wanted / kMaxPanoramaReach, 1.0f);
  return result;
}

IBR_SHARED_END

#endif
