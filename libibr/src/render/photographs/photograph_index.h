// SPDX-License-Identifier: Apache-2.0
// Bounding volume hierarchy over the photographs that can be gathered from: finds the most promising ones for a view in
// time that hardly depends on the number of the others. Pure.
//
// The promise of a photograph estimates its coverage (photograph_values.h) at the middle of the view, for points at two
// depths: Σ overlap / √(kGatherAngleFloor + angle). It decreases with the photograph's distance across and along the
// viewing axis, and with the angle between its axis and the point. A node's promise is that at the least distances and
// angles of its photographs. Angles are measured as chords of the unit circle, 2 sin(angle / 2), which need no
// arctangent and fulfil the triangle inequality, too.
#pragma once

#include <cstdint>
#include <memory_resource>
#include <vector>

#include "base/halved_tree.h"
#include "ibr/frame_plan.h"

namespace ibr {

struct PhotographIndex {
  struct Photograph {
    std::uint32_t node = 0, backdrop = 0;  // indices into Scene::nodes and backdrops
    glm::dvec3 position{0.0}, axis{0.0};   // of the camera, world; the axis has length 1
    double field = 0;                      // largest chord between the axis and a corner
  };
  struct Node : HalvedNode {
    glm::dvec3 centre{0.0};  // of a ball with the positions
    double radius = 0;
    glm::dvec3 axis{0.0};  // of a cone with the optical axes, length 1
    double spread = 0;     // largest chord between it and an optical axis
    double field = 0;      // largest of the photographs'
  };
  std::vector<Node> nodes;              // over `photographs`
  std::vector<Photograph> photographs;  // in the order of the leaves
};

/// Indexes backdrops with evidence in the mesh and a depth texture. A leaf has at most `leafSize` photographs, >= 1.
PhotographIndex makePhotographIndex(const Scene& scene, std::uint32_t leafSize = 8);

/// Returns the `most` photographs of the greatest promise, among equals the first backdrops; sorted by backdrop.
std::pmr::vector<PhotographIndex::Photograph> promisingPhotographs(const PhotographIndex& index,
                                                                   const std::vector<Camera>& views, const Pose& middle,
                                                                   double medianInverseDepth, std::size_t most,
                                                                   std::pmr::memory_resource* memory);

}  // namespace ibr
