// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace ibr::app {

/// How far a view may be trusted.
struct Trust {
  std::array<double, 4> tiers{};  // shares of the pixels by tier: photographs agree, none, completed, invented or empty
  double extrapolation = 0;       // of the main cell, in its sizes; infinite where there is none
  double depthError = 0;  // median of σ_ρ / ρ over the pixels whose depth is known: 0.01 is a hundredth of it
};

}  // namespace ibr::app
