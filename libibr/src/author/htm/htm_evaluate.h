// SPDX-License-Identifier: Apache-2.0
// [H] Alg. 6: which faces are worth dividing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "author/htm/htm_visibility.h"

namespace ibr {

struct EvaluateOptions {
  double meanDifference = 1;  // levels of D_f: no face is divided for its difference where the mean is at most this
  double faceDifference = 4;  // a face beyond it is
  bool selfOccluded = true;   // and so is one that is hidden in part
  double leastFacePx = 250;   // px² in the camera that sees most of it: smaller faces stay
};

struct EvaluatedFaces {
  std::vector<std::uint8_t> divide;  // of each face, 0 or 1
  std::size_t divided = 0;           // how many
  std::size_t hidden = 0;            // of these for being hidden in part alone
};

/// `differences`: D_f of each face, finite. `views`, `visibility`: of the mesh at full size.
EvaluatedFaces evaluateFaces(const TriangleMesh& mesh, std::span<const ProjectedMesh> views,
                             std::span<const FaceVisibility> visibility, std::span<const double> differences,
                             const EvaluateOptions& options);

}  // namespace ibr
