// SPDX-License-Identifier: Apache-2.0
#include "author/eval/exposed_picture.h"

#include <algorithm>
#include <cmath>
#include <glm/exponential.hpp>

#include "shared/cell.h"

namespace ibr {

Image8 applyGain(Image8 picture, glm::dvec3 gain) {
  const shader::vec3 gains(gain), slopes(glm::pow(gain, glm::dvec3(1 / 2.4)));
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const auto pixel = picture.pixel(x, y);
      const shader::vec3 shown =
          255.0f * shader::exposedColour(shader::vec3(pixel[0], pixel[1], pixel[2]) / 255.0f, gains, slopes);
      for (int c = 0; c < 3; ++c) pixel[std::size_t(c)] = std::uint8_t(std::lround(std::clamp(shown[c], 0.0f, 255.0f)));
    }
  return picture;
}

}  // namespace ibr
