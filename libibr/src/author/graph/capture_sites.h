// SPDX-License-Identifier: Apache-2.0
// Places from which several photographs were taken ([T] §2.4.2, ordered acquisition: the camera is turned on the spot).
//
//   single linkage: sort the edges of the minimum spanning tree of the positions; where the length jumps by more than
//   kGap from one edge to the next, cut. Largest jump first, until the spots that it gives look like spots:
//   small beside the distances between them, hardly one with a single photograph, and the photographs of a spot
//   look in different directions (else it is a cluster that was photographed densely) unless they are at one point.
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
/// The shortest tree that joins all points, edges ascending (Prim).
std::vector<TreeEdge> spanningTree(std::span<const glm::dvec3> points);

/// The components (numbered in order of their first point) when some edges are drawn between `count` points.
std::vector<std::uint32_t> components(std::size_t count, std::span<const TreeEdge> edges);

/// The spot of each camera, numbered in order of their first camera. Every camera is its own spot where no jump fits.
std::vector<std::uint32_t> findSpots(std::span<const Camera> cameras);

}  // namespace ibr
