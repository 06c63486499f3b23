// SPDX-License-Identifier: Apache-2.0
// Refines swept depth to a fraction of a level, in finer images than the sweep's (after PatchMatch Stereo: Bleyer,
// Rhemann & Rother, BMVC 2011).
//
// Each pixel has a plane. Its cost is the mean over the better two thirds of at most five sources of 1 − ZNCC of 5×5
// samples, 2 px of the fine image apart, weighted by exp(−|difference from the middle sample| / 25). The sources are
// those that agree best with the swept depth.
//
// Three scans, forward and backward in turn, try at each pixel: the planes of the two neighbours visited before; the
// own plane moved by ± 0.35, 0.18, 0.09 of a level; a random slope. A plane is taken if its cost is lower by
// kMinGain. Where the mean cost of 5×5 pixels stays above kMaxCost, the swept depth is kept.
#pragma once

#include <span>

#include "author/depth/photograph_sweep.h"

namespace ibr {

/// Refines depth.inverseDepth except in the sky and where unknown. `photograph` and `sources`: those of the sweep, at
/// any size, e.g. twice the depth's. The sources' masks are 0 where pixels must not be read. Deterministic for any
/// number of threads.
void refineDepth(SweptDepth& depth, const SweepView& photograph, std::span<const SweepView> sources);
/// Memory in addition to the images, bytes per pixel.
inline constexpr double kRefinedBytesPerPixel = 40;

}  // namespace ibr
