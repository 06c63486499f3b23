// SPDX-License-Identifier: Apache-2.0
// What follows the search of [H] Alg. 3: matches between pixels, and how well they are known.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>

#include "ibr/image.h"
#include "ibr/template_search.h"

namespace ibr {

/// What a pair of pictures says about a vertex.
struct VertexMatch {
  glm::vec2 displacement{0.0f};  // px of picture i: the complement; 0 in directions without texture
  glm::vec3 information{0.0f};   // its inverse covariance xx, xy, yy, 1 / px²; 0: nothing was measured
  float cost = 0;                // at the match, as the measure says
};

/// A whole-pixel match made finer where the picture's gradients allow (Lucas and Kanade 1981, translation only, each
/// colour about its own mean), and what it is worth. `at`: displacement, px. Samples lie near to each other: memory is
/// that of their box.
VertexMatch refinedMatch(const Image8& picture, std::span<const TemplateSample> samples, glm::dvec2 at,
                         double leastTexture);

}  // namespace ibr
