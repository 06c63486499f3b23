// SPDX-License-Identifier: Apache-2.0
// First step of [H] Alg. 1: collapses edges by shape until the mean face is large. Order and new positions are those of
// Garland and Heckbert, Surface simplification using quadric error metrics (1997).
#pragma once

#include <cstddef>
#include <optional>

#include "author/cgal/surface_distance.h"
#include "author/surface/repair_mesh.h"
#include "ibr/log.h"

namespace ibr {

struct HtmReduceOptions {
  /// Minimum mean area of a face after the reduction, in the mesh's unit squared; 0: no limit.
  double meanFaceArea = 0;
  /// Maximum number of faces after the reduction; 0: no limit. With both limits, both must hold.
  std::size_t faceCount = 0;
  /// Maximum angle by which one collapse turns a face's normal.
  double maxTurnDegrees = 60;
  /// Sample points per surface for distances; 0: distances are not measured.
  std::size_t distanceSamples = 20000;
  ProgressCallback progress;
};

struct HtmReduceReport {
  RepairReport repair;
  std::size_t facesBefore = 0, facesAfter = 0;  // of the repaired mesh, and of the result
  std::size_t collapses = 0;
  double meanFaceArea = 0;                // of the result
  bool reached = false;                   // the requested limits hold
  SurfaceDistance toReduced, toOriginal;  // from the repaired mesh to the result, and back
};

struct ReducedMesh {
  TriangleMesh mesh;
  HtmReduceReport report;
};

/// The mesh is repaired first; the result is manifold and of the same topology, as repairMesh's. Borders stay borders.
/// Deterministic. Throws Error{invalidInput} if the mesh has no usable face or an option is out of range,
/// Error{cancelled}.
ReducedMesh reduceMesh(const TriangleMesh& mesh, const HtmReduceOptions& options);

}  // namespace ibr
