// SPDX-License-Identifier: Apache-2.0
// Sub-pixel refinement of the matches of [H] Alg. 3, with their precision.
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>

#include "ibr/image.h"
#include "ibr/template_search.h"

namespace ibr {

/// Match of a vertex between two images.
struct VertexMatch {
  glm::vec2 displacement{0.0f};  // px of image i: the complement; 0 in directions without texture
  glm::vec3 information{0.0f};   // inverse covariance of the displacement: xx, xy, yy, 1 / px²; 0: not measured
  float cost = 0;                // at the match, in the unit of the measure
};

/// Refines a whole-pixel match by image gradients and returns its precision (Lucas and Kanade 1981, translation only,
/// each colour relative to its mean). `at`: displacement, px. Memory is that of the samples' bounding box: samples must
/// lie near each other.
VertexMatch refinedMatch(const Image8& picture, std::span<const TemplateSample> samples, glm::dvec2 at,
                         double minTexture);

}  // namespace ibr
