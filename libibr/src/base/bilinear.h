// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "ibr/image.h"

namespace ibr {

/// Bilinear sample; the border's values continue outwards. `at` in px, pixel centres at halves.
inline glm::dvec3 bilinear(const Image8& picture, glm::dvec2 at) {
  const double u = std::clamp(at.x - 0.5, 0.0, picture.width - 1.0),
               v = std::clamp(at.y - 0.5, 0.0, picture.height - 1.0);
  const int x = std::min(int(u), picture.width - 1), y = std::min(int(v), picture.height - 1);
  const int right = std::min(x + 1, picture.width - 1), below = std::min(y + 1, picture.height - 1);
  const double s = u - x, t = v - y;
  glm::dvec3 colour;
  for (std::size_t c = 0; c < 3; ++c)
    colour[int(c)] = (1 - t) * ((1 - s) * picture.pixel(x, y)[c] + s * picture.pixel(right, y)[c]) +
                     t * ((1 - s) * picture.pixel(x, below)[c] + s * picture.pixel(right, below)[c]);
  return colour;
}

}  // namespace ibr
