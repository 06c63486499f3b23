// SPDX-License-Identifier: Apache-2.0
// [H] Alg. 1, second step: faces whose textures disagree are made larger, so that they hold more for matching to go by.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <vector>

#include "ibr/htm_model.h"
#include "ibr/log.h"

namespace ibr {

/// D_f ([H] Alg. 4) of each of `faces`, indices into the mesh's triangles, in their order. NaN or infinite: unknown. Of
/// the mesh's triangles those with three equal corners are no longer there; vertices and faces keep their indices from
/// call to call.
using FaceDifferences =
    std::function<std::vector<double>(const TriangleMesh& mesh, std::span<const std::uint32_t> faces)>;

struct HtmCollapseOptions {
  /// Only faces with a smaller area, in the mesh's unit squared, are collapsed.
  double faceArea = 0;
  /// It ends when no such face has a larger difference than this.
  double floor = 0;
  std::size_t mostCollapses = std::numeric_limits<std::size_t>::max();
  /// Collapses between two calls of `differences`, at places that do not touch; 1 is the paper's.
  std::size_t batch = 1;
  /// A face's normal turns by no more than this in one collapse.
  double largestTurnDegrees = 60;
  ProgressCallback progress;
};

enum class HtmCollapseEnd { noFace, cap };

struct HtmCollapseReport {
  std::size_t facesBefore = 0, facesAfter = 0, collapses = 0;
  std::size_t refused = 0;    // small faces above the floor that are left, since no edge of theirs may be collapsed
  std::size_t unknown = 0;    // faces left whose difference is not known
  std::size_t evaluated = 0;  // faces handed to `differences`, over all calls
  double meanBefore = 0, meanAfter = 0, largestBefore = 0, largestAfter = 0;  // of the differences that are known
  HtmCollapseEnd end = HtmCollapseEnd::noFace;
};

struct CollapsedMesh {
  TriangleMesh mesh;
  std::vector<double> differences;  // of each face
  HtmCollapseReport report;
};

/// Again and again the face with the largest difference among the small ones loses its shortest edge that may go: the
/// topology stays and no normal turns too far. The merged vertex lies where it deviates least from the faces around.
/// Ends for any mesh (it is repaired first) and any differences: each collapse takes a face away, and a face that can
/// lose no edge is not tried again before something beside it has changed. Throws Error{invalidInput} where an option
/// is out of range or `differences` returns another number of values, Error{cancelled}.
CollapsedMesh collapseDifferences(const TriangleMesh& mesh, const FaceDifferences& differences,
                                  const HtmCollapseOptions& options);

}  // namespace ibr
