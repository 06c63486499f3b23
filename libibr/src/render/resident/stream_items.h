// SPDX-License-Identifier: Apache-2.0
// Numbers of the items of a scene that can be streamed.
#pragma once

#include <cstddef>
#include <cstdint>

#include "ibr/scene.h"

namespace ibr {

/// Photographs first, with the numbers of their nodes; then depth textures in the same order, meshes of cells, meshes
/// of backdrops.
struct StreamItems {
  StreamItems() = default;
  explicit StreamItems(const Scene& scene)
      : nodes(std::uint32_t(scene.nodes.size())),
        cells(std::uint32_t(scene.cells.size())),
        backdrops(std::uint32_t(scene.backdrops.size())) {}

  std::uint32_t depth(std::uint32_t node) const noexcept { return nodes + node; }
  std::uint32_t cell(std::uint32_t index) const noexcept { return mesh(index); }
  std::uint32_t backdrop(std::uint32_t index) const noexcept { return mesh(cells + index); }
  /// `index`: among the cells and then the backdrops.
  std::uint32_t mesh(std::uint32_t index) const noexcept { return 2 * nodes + index; }

  bool isDepth(std::uint32_t item) const noexcept { return item >= nodes && item < 2 * nodes; }
  bool isMesh(std::uint32_t item) const noexcept { return item >= 2 * nodes; }
  std::uint32_t node(std::uint32_t item) const noexcept { return item < nodes ? item : item - nodes; }  // of a texture
  std::uint32_t meshIndex(std::uint32_t item) const noexcept { return item - 2 * nodes; }

  std::size_t count() const noexcept { return 2 * std::size_t(nodes) + cells + backdrops; }

  std::uint32_t nodes = 0, cells = 0, backdrops = 0;
};

}  // namespace ibr
