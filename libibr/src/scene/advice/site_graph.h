// SPDX-License-Identifier: Apache-2.0
// Capture sites of the photographs, and their neighbours.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "ibr/scene.h"
#include "scene/advice/depth_grid.h"

namespace ibr {

struct CaptureSite {
  glm::dvec3 position{0.0};           // mean of its photographs' positions
  std::vector<std::uint32_t> nodes;   // ascending by name
  std::vector<std::uint32_t> beside;  // sites, ascending: relative neighbours
};

/// Connection of a site to a neighbour: no third site is nearer to both than they are to each other (Toussaint 1980).
/// These connections link all sites.
struct SiteLink {
  std::uint32_t a, b;  // sites, a < b
  double length;       // world units
  bool joined;         // a cell has photographs of both
};

struct SiteGraph {
  std::vector<CaptureSite> sites;
  std::vector<SiteLink> links;
  std::vector<std::uint32_t> siteOf;  // of each node
  double step = 0;                    // median length of a link; 0 if there is none
  bool row = false;                   // no cell spans more than two sites, so cells show only paths along links
};

/// Photographs share a site if near objects (at median DepthGrid::near) shift by less than 0.003 radians between
/// them. Independent of the nodes' order and of the world's position, rotation and scale.
SiteGraph buildSiteGraph(const Scene& scene, const std::vector<DepthGrid>& depths);

}  // namespace ibr
