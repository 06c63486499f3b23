// SPDX-License-Identifier: Apache-2.0
// Error of colour tables estimated from few pixels ([T] §2.5.3), measured on a photograph whose colours are
// changed by a known curve.
#pragma once

#include <cstdint>
#include <vector>

#include "ibr/image.h"

namespace ibr::app {

struct MapError {
  int samples;   // pixels
  double same;   // 8-bit levels, mean over the photograph: both histograms from the same pixels, as in the renderer
  double apart;  // the same with independently chosen pixels for each histogram
};

/// Returns errors for 10, 30, 100 … pixels, up to the photograph's; means over a few draws. Deterministic.
std::vector<MapError> mapErrors(const Image8& photograph, std::uint64_t seed);

}  // namespace ibr::app
