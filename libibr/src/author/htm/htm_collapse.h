// SPDX-License-Identifier: Apache-2.0
// Second step of [H] Alg. 1: enlarges faces whose textures disagree, so that they give matching more texture.
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

/// Returns D_f ([H] Alg. 4) of each of `faces` (indices into the mesh's triangles), in their order. NaN or infinite:
/// unknown. Triangles with three equal corners are removed faces. Vertices and faces keep their indices from call to
/// call.
using FaceDifferences =
    std::function<std::vector<double>(const TriangleMesh& mesh, std::span<const std::uint32_t> faces)>;

struct HtmCollapseOptions {
  /// Only faces with a smaller area are collapsed; unit: the mesh's unit squared.
  double faceArea = 0;
  /// The collapse ends when no such face has a larger difference.
  double floor = 0;
  std::size_t maxCollapses = std::numeric_limits<std::size_t>::max();
  /// Collapses between two calls of `differences`, at faces that do not touch; the paper's value is 1.
  std::size_t batch = 1;
  /// Maximum angle by which one collapse turns a face's normal.
  double maxTurnDegrees = 60;
  ProgressCallback progress;
};

enum class HtmCollapseEnd { noFace, cap };

struct HtmCollapseReport {
  std::size_t facesBefore = 0, facesAfter = 0, collapses = 0;
  std::size_t refused = 0;    // small faces above the floor none of whose edges may be collapsed
  std::size_t unknown = 0;    // remaining faces of unknown difference
  std::size_t evaluated = 0;  // faces passed to `differences`, over all calls
  double meanBefore = 0, meanAfter = 0, maxBefore = 0, maxAfter = 0;  // of the known differences
  HtmCollapseEnd end = HtmCollapseEnd::noFace;
};

struct CollapsedMesh {
  TriangleMesh mesh;
  std::vector<double> differences;  // of each face
  HtmCollapseReport report;
};

/// Repeatedly collapses the shortest allowed edge of the small face with the largest difference. A collapse is allowed
/// if it keeps the topology and turns no normal too far. The merged vertex lies where it deviates least from the faces
/// around. The mesh is repaired first. The loop always ends: each collapse removes a face, and a face without an
/// allowed edge is tried again only after a face beside it has changed. Throws Error{invalidInput} if an option is out
/// of range or `differences` returns another number of values, Error{cancelled}.
CollapsedMesh collapseDifferences(const TriangleMesh& mesh, const FaceDifferences& differences,
                                  const HtmCollapseOptions& options);

}  // namespace ibr
