// SPDX-License-Identifier: Apache-2.0
// A figure of a few boxes that bends, turns and swings its arms: exact photographs for 3D video with known truth.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "ibr/htm_model.h"
#include "lab/generate/synthetic.h"

namespace ibr {

/// A mesh whose textures move with the surface.
struct TexturedMesh {
  TriangleMesh mesh;
  std::vector<std::array<glm::dvec2, 3>> textureAt;  // of each triangle's corners, world units of the mesh at rest
  std::vector<std::uint32_t> textureOf;              // of each triangle, index of its first in `textures`
  std::uint32_t layers = 1;                          // textures per triangle; their sum keeps the contrast
  std::vector<TexturedPlane> textures;               // seed and wavelength are used
};

/// Closed parts that touch or overlap, facing outward; about 1.7 high, feet at the origin, y up. The movement has
/// period 1; parts and triangles are the same at all times. `divisions`: along the longest edge of a part.
TexturedMesh movingFigure(double phase, std::uint64_t seed, int divisions = 48);

/// Simulates a reconstruction: moves each vertex along its normal by smooth waves of the given standard deviation, with
/// other waves at each phase.
TriangleMesh inexactMesh(const TriangleMesh& mesh, double deviation, double phase, std::uint64_t seed);

struct MeshPhotograph {
  Image8 colours;  // RGB; grey 60 behind the mesh
  Image8 mask;     // grey: share of the pixel that the mesh covers, 255 for all
};

/// Renders the photograph of a pinhole camera: the mean of samplesPerAxis² samples per pixel. Skips triangles that are
/// behind the camera or cross its plane.
MeshPhotograph photograph(const TexturedMesh& mesh, const Camera& camera, int samplesPerAxis = 3);

}  // namespace ibr
