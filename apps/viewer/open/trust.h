// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace ibr::app {

/// Trust statistics of a view.
struct Trust {
  std::array<double, 4> tiers{};  // shares of pixels by tier: 0 photographs agree, 1 none, 2 completed, 3 fill or hole
  double extrapolation = 0;       // of the main cell, in units of the cell's size; infinite without a cell
  double depthError = 0;          // median of σ_ρ / ρ over pixels with known depth, i.e. the relative depth error
};

}  // namespace ibr::app
