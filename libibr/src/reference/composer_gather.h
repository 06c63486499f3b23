// SPDX-License-Identifier: Apache-2.0
// The gather: the colour of a surface is the mean of the photographs that see it best, each read as coarsely as the
// surface's uncertain depth moves it.
#pragma once

#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "reference/composer_photograph.h"

namespace ibr::reference {

struct Gathered {
  glm::dvec3 colour{0};  // display-encoded, 0 to 1 where gains are 1
  double variance = 0;   // of the photographs' colours, 8-bit levels², mean over channels
  bool known = false;    // a photograph sees the surface
};

class Gather {
 public:
  /// `colours`: photographs of a mean, at least 1; `detail`: texels read a texel that the view asks for. The candidates
  /// must outlive it.
  Gather(const Camera& view, std::span<const Candidate> candidates, std::size_t colours, double detail);

  /// The surface at ρ (along the view's axis) of a pixel, which may be off by a share of itself. Thread-safe.
  Gathered at(glm::dvec2 pixel, double inverseDepth, double uncertainty = 0) const;

 private:
  std::vector<PhotographSampler> samplers_;
  std::size_t colours_;
  double detail_;
};

}  // namespace ibr::reference
