// SPDX-License-Identifier: Apache-2.0
// [H] Alg. 1, first step: edges are collapsed with respect to shape until faces are large on average. The order and the
// new positions are those of Garland and Heckbert, Surface simplification using quadric error metrics (1997).
#pragma once

#include <cstddef>
#include <optional>

#include "author/cgal/surface_distance.h"
#include "author/surface/repair_mesh.h"
#include "ibr/log.h"

namespace ibr {

struct HtmReduceOptions {
  /// It goes on until the mean area of a face is at least this, in the mesh's unit squared; 0: not asked for.
  double meanFaceArea = 0;
  /// Or until there are at most so many faces; 0: not asked for. With both, until both hold.
  std::size_t faceCount = 0;
  /// A face's normal turns by no more than this in one collapse.
  double largestTurnDegrees = 60;
  /// Points on each surface that distances are taken at; 0: not measured.
  std::size_t distanceSamples = 20000;
  ProgressCallback progress;
};

struct HtmReduceReport {
  RepairReport repair;
  std::size_t facesBefore = 0, facesAfter = 0;  // of the repaired mesh, and of the result
  std::size_t collapses = 0;
  double meanFaceArea = 0;                // of the result
  bool reached = false;                   // what was asked for
  SurfaceDistance toReduced, toOriginal;  // from the repaired mesh to the result, and back
};

struct ReducedMesh {
  TriangleMesh mesh;
  HtmReduceReport report;
};

/// The mesh is repaired first; the result is as repairMesh's: manifold, of the same topology. Borders stay borders.
/// Deterministic. Throws Error{invalidInput} where the mesh has no usable face or an option is out of range,
/// Error{cancelled}.
ReducedMesh reduceMesh(const TriangleMesh& mesh, const HtmReduceOptions& options);

}  // namespace ibr
