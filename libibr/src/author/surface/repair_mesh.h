// SPDX-License-Identifier: Apache-2.0
// Repairs any triangles into an oriented manifold mesh, for algorithms that walk from face to face.
#pragma once

#include <cstddef>

#include "ibr/htm_model.h"

namespace ibr {

struct RepairReport {
  std::size_t unusableFaces = 0;        // removed: a corner without vertex or not finite, two corners at one position
  std::size_t duplicateFaces = 0;       // removed: the same three corners as an earlier face
  std::size_t stitchedEdges = 0;        // coincident borders, joined
  std::size_t flippedFaces = 0;         // with reversed corner order
  std::size_t cutEdges = 0;             // with more than two faces, or two whose orientations cannot agree
  std::size_t surplusFaces = 0;         // removed, since edges remained non-manifold however they were cut
  std::size_t degenerateFaces = 0;      // three corners on a line: replaced by an edge flip, or removed
  std::size_t degenerateFacesLeft = 0;  // of these, faces that could not be removed
  std::size_t verticesBefore = 0, verticesAfter = 0;  // unused ones are removed; those with several fans split
  bool changed = false;                               // true if the mesh changed
};

struct RepairedMesh {
  TriangleMesh mesh;
  RepairReport report;
};

/// Every edge of the result has one face or two, which run along it in opposite directions; the faces at a vertex form
/// one fan; no vertex is unused. At an edge of several sheets, two faces stay joined if the rest of the surface joins
/// them too (a box with a fin, two boxes that touch); otherwise all are cut apart. A connected part whose faces already
/// agree keeps its orientation. Otherwise a closed part gets positive volume, and an open one the majority's
/// orientation. Repairing a repaired mesh changes nothing. Positions are neither moved nor added. Never throws for any
/// mesh; may return one without faces.
RepairedMesh repairMesh(const TriangleMesh& mesh);

}  // namespace ibr
