// SPDX-License-Identifier: Apache-2.0
// The places that photographs were taken from, and which of them are neighbours.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "ibr/scene.h"
#include "scene/advice/photograph_depth.h"

namespace ibr {

struct CaptureSite {
  glm::dvec3 position{0.0};           // the mean of its photographs'
  std::vector<std::uint32_t> nodes;   // ascending by name
  std::vector<std::uint32_t> beside;  // places, ascending: relative neighbours
};

/// From one place to a neighbour: no third place is nearer to both than they are to each other (Toussaint 1980). All
/// places are connected by such ways.
struct Way {
  std::uint32_t a, b;  // places, a < b
  double length;       // world units
  bool joined;         // a cell has photographs of both
};

struct Places {
  std::vector<CaptureSite> places;
  std::vector<Way> ways;
  std::vector<std::uint32_t> placeOf;  // of each node
  double step = 0;                     // median length of a way; 0 where there is none
  bool row = false;                    // no cell spans more than a line: one walks along, never aside
};

/// Photographs stand at one place where near things (the median of PhotographDepth::near) would shift by less than
/// 0.003 radians from one to the next. Neither the order of nodes nor the world's position, rotation or scale matter.
Places findPlaces(const Scene& scene, const std::vector<PhotographDepth>& depths);

}  // namespace ibr
