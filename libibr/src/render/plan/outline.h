// SPDX-License-Identifier: Apache-2.0
// Outline of a cell's mesh for occlusion (cover_mask.h), of bounded length. Pure.
//
// A vertex is seen along D = Σ λ_i R_i a_i r_i + ρ·t, which is linear in the vertex's values (a_i r_i, ρ). Where the
// values of a chain of edges differ from those of the segment between its ends by at most (δ_i, ε), the chain is seen
// within Σ |λ_i| δ_i + ε |t| of the segment, for every camera and every motion of the mesh. A long outline is replaced
// by such chains. Small loops near each other become one chain of length 0, whose deviation is a radius.
#pragma once

#include "ibr/frame_plan.h"

namespace ibr {

/// Maximum number of edges of CellBounds::outline.
inline constexpr std::size_t kMaxOutlineEdges = 192;

/// Sets CellBounds::corners and outline. Precondition: CellBounds::size is set. A mesh with a long border covers
/// little: its outline is left empty.
void addOutline(const Scene& scene, const Cell& cell, CellBounds& bounds);

}  // namespace ibr
