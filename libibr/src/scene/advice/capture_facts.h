// SPDX-License-Identifier: Apache-2.0
// Facts about a capture on which advice is based: distances, capture sites and the photographs that cells join.
#pragma once

#include <cstdint>
#include <vector>

#include "ibr/scene.h"
#include "scene/advice/depth_grid.h"
#include "scene/advice/site_graph.h"

namespace ibr {

struct CaptureFacts {
  const Scene& scene;
  std::vector<DepthGrid> depths;  // one per node
  SiteGraph siteGraph;
  std::vector<std::uint32_t> siteGroup;                // one per site: equal numbers for sites that cells join
  std::vector<bool> used;                              // one per node: the node is a member of a cell
  std::vector<std::vector<std::uint32_t>> neighbours;  // one list per node: nodes that share a cell with it, ascending
};

/// Precondition: validate(scene) is empty. The scene must outlive the result.
CaptureFacts captureFacts(const Scene& scene);

/// True if a photograph of the site is a member of a cell.
bool isUsedSite(const CaptureFacts& facts, std::uint32_t site);

}  // namespace ibr
