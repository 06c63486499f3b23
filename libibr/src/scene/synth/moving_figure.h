// SPDX-License-Identifier: Apache-2.0
// A figure of a few boxes that bends, turns and swings its arms, photographed exactly: 3D video whose truth is known.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "ibr/htm_model.h"
#include "scene/synth/synthetic.h"

namespace ibr {

/// A mesh that carries textures as it moves.
struct TexturedMesh {
  TriangleMesh mesh;
  std::vector<std::array<glm::dvec2, 3>> textureAt;  // of each triangle's corners, world units of the mesh at rest
  std::vector<std::uint32_t> textureOf;              // of each triangle, index of its first in `textures`
  std::uint32_t layers = 1;                          // textures of a triangle, added up so that the contrast stays
  std::vector<TexturedPlane> textures;               // seed and wavelength are used
};

/// Closed parts that touch or overlap, outward; about 1.7 high, feet at the origin, y up. The movement has period 1,
/// the parts and their triangles are the same at all times. `divisions`: along the longest edge of a part.
TexturedMesh movingFigure(double phase, std::uint64_t seed, int divisions = 48);

/// The figure as reconstructed: each vertex moved along its normal by smooth waves of that standard deviation, other
/// ones at each phase.
TriangleMesh inexactMesh(const TriangleMesh& mesh, double deviation, double phase, std::uint64_t seed);

struct MeshPhotograph {
  Image8 colours;  // RGB; grey 60 behind the mesh
  Image8 mask;     // grey: share of the pixel that the mesh covers, 255 for all
};

/// What a pinhole camera would photograph: the mean of samplesPerAxis² samples a pixel. What lies behind the camera or
/// crosses its plane is left out.
MeshPhotograph photograph(const TexturedMesh& mesh, const Camera& camera, int samplesPerAxis = 3);

}  // namespace ibr
