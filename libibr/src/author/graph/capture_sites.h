// SPDX-License-Identifier: Apache-2.0
// Finds capture sites with several photographs each ([T] §2.4.2, ordered acquisition: the camera is rotated).
//
// Single linkage: sort the edges of the minimum spanning tree of the positions; cut where the length jumps by more than
// kMinGapRatio from one edge to the next. Jumps are tried largest first, until the clusters are capture sites: small
// compared with their distances, few with a single photograph, and with photographs in different directions (else they
// are a dense capture), unless at one point.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "ibr/camera.h"

namespace ibr {

struct TreeEdge {
  double length;
  std::uint32_t a, b;  // indices of points
};
/// Minimum spanning tree of the points (Prim), edges ascending.
std::vector<TreeEdge> spanningTree(std::span<const glm::dvec3> points);

/// Connected components of `count` points with some edges, numbered in order of their first point.
std::vector<std::uint32_t> components(std::size_t count, std::span<const TreeEdge> edges);

/// Capture site of each camera, numbered by first camera. Without a suitable jump each camera has its own.
std::vector<std::uint32_t> findCaptureSites(std::span<const Camera> cameras);

}  // namespace ibr
