// SPDX-License-Identifier: Apache-2.0
// The gather: averages the photographs that see a surface best. Each is filtered as coarsely as the uncertainty of the
// surface's depth requires.
#pragma once

#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "reference/composer_photograph.h"

namespace ibr::reference {

struct Gathered {
  glm::dvec3 colour{0};  // display-encoded, 0 to 1 if gains are 1
  double variance = 0;   // of the photographs' colours, 8-bit levels², mean over channels
  bool known = false;    // a photograph sees the surface
};

class Gather {
 public:
  /// `colours`: number of photographs that are averaged, at least 1; `detail`: texels read per texel that the view
  /// needs. The candidates must outlive the object.
  Gather(const Camera& view, std::span<const Candidate> candidates, std::size_t colours, double detail);

  /// Colour of the surface at ρ (along the view's axis) of a pixel; `uncertainty`: relative, of ρ. Thread-safe.
  Gathered at(glm::dvec2 pixel, double inverseDepth, double uncertainty = 0) const;

 private:
  std::vector<PhotographSampler> samplers_;
  std::size_t colours_;
  double detail_;
};

}  // namespace ibr::reference
