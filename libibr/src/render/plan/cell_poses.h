// SPDX-License-Identifier: Apache-2.0
// Camera poses of a cell's members, copied beside each other: planning reads those of every cell near a view, and
// memory that is far apart would cost more time than the computation.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "ibr/scene.h"

namespace ibr {

struct CellPoses {
  std::array<Pose, 4> pose;                            // as Cell::members
  std::array<std::uint8_t, 4> byPosition{0, 1, 2, 3};  // members sorted by position
  std::uint8_t count = 0;                              // of members
  std::uint8_t panoramas = 0;                          // one bit per member

  std::span<const Pose> poses() const { return std::span(pose).first(count); }
  bool isPanorama(std::size_t member) const { return (panoramas >> member & 1) != 0; }
};

CellPoses cellPoses(const Scene& scene, const Cell& cell);

}  // namespace ibr
