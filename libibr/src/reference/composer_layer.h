// SPDX-License-Identifier: Apache-2.0
// Draws a photograph's mesh into the view: the photograph's hypothesis for every pixel of the vote.
#pragma once

#include <glm/gtc/type_precision.hpp>
#include <vector>

#include "ibr/camera.h"
#include "ibr/image.h"
#include "ibr/scene.h"
#include "reference/composer_photograph.h"

namespace ibr::reference {

/// Depth of a photograph with its confirmation by other photographs. Three maps of one size.
struct PhotographDepth {
  ImageF inverseDepth;    // along the axis, 1 / world unit, >= 0; defined everywhere
  Image8 confirmations;   // c: number of photographs with the same depth there; 0 where depth was completed
  ImageF consensus;       // a: (c + .25) / (c + v + .5), v photographs that see past it; .1 where completed
  double step = 0;        // ρ that moves a point by 1 px at half the photograph's size over the spacing b, > 0
  double residualPx = 0;  // median reprojection residual, px of the photograph
};

/// Surfaces of a photograph. A vertex lies at point / inverseDepth from the photograph's centre, in its axes; at
/// infinity if inverseDepth is 0.
struct HypothesisMesh {
  struct Vertex {
    glm::dvec3 point{0};
    double inverseDepth = 0;
    double trust = 0, consensus = 0;
  };
  std::vector<Vertex> vertices;
  std::vector<glm::uvec3> triangles;
};

/// Tier 0 of a backdrop's mesh. Precondition: one member; confirmations and consensus of every point.
HypothesisMesh hypothesisMesh(const Intrinsics& photograph, const MorphMesh& mesh);

/// A pinhole's depth map as a grid of triangles, cut where depth jumps.
HypothesisMesh hypothesisMesh(const Intrinsics& photograph, const PhotographDepth& depth);

/// A photograph's hypothesis for a pixel.
struct Hypothesis {
  double inverseDepth = 0;          // along the view's axis
  double trust = 0, consensus = 0;  // trust 0: no hypothesis
};

/// Row by row at the view's size; the nearest surface wins. Masked parts of a photograph vote, too: their depth was
/// completed from around the mask.
std::vector<Hypothesis> drawLayer(const Camera& view, const Candidate& candidate, const HypothesisMesh& mesh);

}  // namespace ibr::reference
