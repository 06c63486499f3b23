// SPDX-License-Identifier: Apache-2.0
// The band-limited texture of a TexturedPlane.
#pragma once

#include <array>
#include <cmath>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <numbers>
#include <random>

#include "lab/generate/synthetic.h"

namespace ibr {

// colour(x) = 127.5 + Σ sine_k sin(k·x) + cosine_k cos(k·x); the amplitudes of a channel sum to at most 117.
class WaveTexture {
 public:
  explicit WaveTexture(const TexturedPlane& plane) {
    std::mt19937_64 random(plane.seed);
    auto uniform = [&] { return double(random() >> 11) * 0x1p-53; };  // independent of the standard library
    for (Wave& wave : waves_) {
      const double length = plane.wavelength * std::pow(4.0, uniform());
      const double angle = 2.0 * std::numbers::pi * uniform();
      wave.k = 2.0 * std::numbers::pi / length * glm::dvec2(std::cos(angle), std::sin(angle));
      for (int c = 0; c < 3; ++c) {
        const double phase = 2.0 * std::numbers::pi * uniform();
        const double amplitude = (0.5 + 0.5 * uniform()) * 117.0 / double(waves_.size());
        wave.sine[c] = amplitude * std::sin(phase);
        wave.cosine[c] = amplitude * std::cos(phase);
      }
    }
  }

  glm::dvec3 colour(glm::dvec2 at) const {
    glm::dvec3 sum(127.5);
    for (const Wave& wave : waves_) {
      const double phase = wave.k.x * at.x + wave.k.y * at.y;
      sum += wave.sine * std::sin(phase) + wave.cosine * std::cos(phase);
    }
    return sum;
  }

 private:
  struct Wave {
    glm::dvec2 k;
    glm::dvec3 sine, cosine;
  };
  std::array<Wave, 5> waves_;
};

}  // namespace ibr
