// SPDX-License-Identifier: Apache-2.0
// Any triangles → an oriented manifold mesh, for the steps that walk from face to face.
#pragma once

#include <cstddef>

#include "ibr/htm_model.h"

namespace ibr {

struct RepairReport {
  std::size_t unusableFaces = 0;   // left out: a corner that is not finite or has no vertex, two corners in one place
  std::size_t duplicateFaces = 0;  // left out: the same three corners as an earlier face
  std::size_t stitchedEdges = 0;   // borders that lay on one another exactly, joined
  std::size_t turnedFaces = 0;     // their corners' order reversed
  std::size_t cutEdges = 0;        // more than two faces met there, or two that no turning makes agree
  std::size_t surplusFaces = 0;    // left out, since edges remained non-manifold however they were cut
  std::size_t flatFaces = 0;       // three corners on a line: replaced by turning an edge, or left out
  std::size_t flatFacesLeft = 0;   // of these, those that nothing could be done about
  std::size_t verticesBefore = 0, verticesAfter = 0;  // unused ones go; ones where several sheets meet are made several
  bool changed = false;                               // anything at all
};

struct RepairedMesh {
  TriangleMesh mesh;
  RepairReport report;
};

/// Every edge of the result has one face or two, which run along it in opposite directions; the faces at a vertex form
/// one fan; no vertex is unused. Where several sheets meet at an edge, two faces stay joined there if the rest of the
/// surface joins them too (a box with a fin, two boxes that touch), otherwise all are cut apart. A connected part whose
/// faces agree already keeps its side; otherwise a closed part's volume becomes positive, and an open one goes by the
/// majority. Repairing a repaired mesh changes nothing. No positions are moved or made up. Never throws for what the
/// mesh is like; may return one without faces.
RepairedMesh repairMesh(const TriangleMesh& mesh);

}  // namespace ibr
