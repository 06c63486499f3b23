// SPDX-License-Identifier: Apache-2.0
// Stand-in of a cell's mesh: few triangles between some of its vertices, drawn while the mesh is not on the device.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "ibr/scene.h"

namespace ibr {

inline constexpr std::size_t kMaxStandInTriangles = 64;

/// Part of a mesh.
struct MeshPart {
  std::vector<std::uint32_t> points;  // vertices of the mesh, ascending
  std::vector<glm::uvec3> triangles;  // indices into `points`
};

/// Returns the triangles of a mesh that are drawn: those of tier 0 whose points are usable (plan/vertex.h).
std::vector<glm::uvec3> drawnTriangles(const Scene& scene, const Cell& cell);

/// Returns a stand-in of at most kMaxStandInTriangles of a cell or backdrop. `triangles`: those that are drawn.
///
/// Vertex clustering (Rossignac and Borrel 1993) in the image of the first member: the vertices nearest to a node of a
/// regular grid become the one that is nearest to the node. Parts of the mesh that are not connected near a node stay
/// apart, unless the stand-in would lack more than a tenth of the mesh's area.
MeshPart meshStandIn(const Cell& cell, const std::vector<glm::uvec3>& triangles);

}  // namespace ibr
