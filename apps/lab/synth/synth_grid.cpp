// SPDX-License-Identifier: Apache-2.0
#include "lab/synth/synth_grid.h"

#include <fmt/format.h>

#include <cassert>
#include <numbers>
#include <utility>

namespace ibr::app {

Scene gridScene(const Scene& corner, int side) {
  assert(side >= 2 && corner.cells.size() == 1 && corner.cells[0].members.size() == 3);
  Scene scene;
  for (int z = 0; z < side; ++z)
    for (int x = 0; x < side; ++x) {
      Node& node = scene.nodes.emplace_back(corner.nodes[0]);
      node.name = fmt::format("{}-{}", x, z);
      node.camera.pose.position = {x, 0, z};
    }
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    Cell& cell = scene.cells.emplace_back(corner.cells[0]);
    cell.members = {a, b, c};
  };
  const auto row = std::uint32_t(side);
  for (std::uint32_t z = 0; z + 1 < row; ++z)
    for (std::uint32_t x = 0; x + 1 < row; ++x) {
      const std::uint32_t n = z * row + x;
      add(n, n + 1, n + row);
      add(n + 1, n + row + 1, n + row);
    }
  return scene;
}

CameraPath gridWalk(int side, int width, int height) {
  constexpr double kMetresPerSecond = 3, kFovY = 0.8;
  const double last = side - 1;
  const auto key = [&](double time, double along) { return CameraKey{time, {along, 0, along}, {1, 0, 0, 0}, kFovY}; };
  return {width, height, 30, {key(0, 0), key(std::numbers::sqrt2 * last / kMetresPerSecond, last)}};
}

}  // namespace ibr::app
