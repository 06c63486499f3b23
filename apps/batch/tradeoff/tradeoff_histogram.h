// SPDX-License-Identifier: Apache-2.0
// How wrong a colour table is that was made from few pixels ([T] §2.5.3; NUMERICS T17), on a photograph whose colours
// are changed by a known curve.
#pragma once

#include <cstdint>
#include <vector>

#include "ibr/image.h"

namespace ibr::app {

struct MapError {
  int samples;   // pixels
  double same;   // levels, mean over the photograph: both histograms of the same pixels, as the renderer counts them
  double apart;  // of pixels drawn for each by itself
};

/// For 10, 30, 100 … pixels up to those of the photograph; means over a few draws. Deterministic.
std::vector<MapError> mapErrors(const Image8& photograph, std::uint64_t seed);

}  // namespace ibr::app
