// SPDX-License-Identifier: Apache-2.0
// Where meshes that show the same photograph can be compared ([T] §2.6.4): places on one grid over each photograph,
// looked up in every mesh that shows it. At a place each mesh has a point of its own. Pure.
#pragma once

#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "ibr/renderer.h"

namespace ibr {

inline constexpr std::uint32_t kAnchorSide = 16;  // places along each side of a photograph

/// For every node, how many of the scene's cells and backdrops show it.
std::vector<std::uint32_t> meshesOfNodes(const Scene& scene);

/// The mesh's tier 0 at places of photographs that are in two meshes or more: the nearest surface along the
/// photograph's ray. Sorted by photograph, then place, each once. Time goes with the number of triangles.
std::vector<CellBounds::Anchor> anchorsOf(const Scene& scene, const Cell& mesh,
                                          std::span<const std::uint32_t> meshesOfNode);

/// Those of all meshes, looked up when they are first asked for: scenes that are not aligned do not pay for them. By
/// any thread.
class AnchorsOnDemand {
 public:
  struct OfMeshes {
    std::vector<std::vector<CellBounds::Anchor>> cells, backdrops;  // as those of the scene
  };
  /// Always of the same scene.
  const OfMeshes& of(const Scene& scene);

 private:
  std::once_flag once_;
  OfMeshes all_;
};

}  // namespace ibr
