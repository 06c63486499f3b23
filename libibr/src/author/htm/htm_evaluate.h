// SPDX-License-Identifier: Apache-2.0
// Selects the faces to subdivide: [H] Alg. 6.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "author/htm/htm_visibility.h"

namespace ibr {

struct EvaluateOptions {
  double meanDifference = 1;  // D_f, 8-bit levels: if the mean is at most this, no face is divided for its difference
  double faceDifference = 4;  // D_f above which a face is divided, 8-bit levels
  bool selfOccluded = true;   // partly hidden faces are divided, too
  double minFacePx = 250;     // px² in the camera that shows the face largest: smaller faces are not divided
};

struct EvaluatedFaces {
  std::vector<std::uint8_t> divide;  // of each face, 0 or 1
  std::size_t divided = 0;           // number of faces
  std::size_t hidden = 0;            // number of faces divided only because they are partly hidden
};

/// `differences`: D_f of each face, finite. `views`, `visibility`: of the mesh at full size.
EvaluatedFaces evaluateFaces(const TriangleMesh& mesh, std::span<const ProjectedMesh> views,
                             std::span<const FaceVisibility> visibility, std::span<const double> differences,
                             const EvaluateOptions& options);

}  // namespace ibr
