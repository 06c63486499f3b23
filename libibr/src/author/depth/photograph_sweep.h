// SPDX-License-Identifier: Apache-2.0
// A photograph's depth from many others: plane sweep in the photograph's own picture, then semi-global matching.
//
//   cost(pixel, ρ) = mean over the better half of the sources that see the pixel of c, where c = 1 − ZNCC of 5×5
//                    windows; of one source alone .5 c + .35, of none .78; c = 1 is 127 in the volume of costs
//
// The better half: in the other sources something may stand before the surface. ρ goes in even steps, of about one
// pixel of the median source, to well before the nearest tracks; from 0 (infinity), unless all tracks are about equally
// far and most photographs see nothing that is farther. Sources that move by more pixels a step are read at a smaller
// size.
#pragma once

#include <span>
#include <vector>

#include "author/sweep/window_correlation.h"
#include "ibr/image.h"

namespace ibr {

/// Maps of one channel each, of the photograph's size.
struct SweptDepth {
  ImageF inverseDepth;  // ρ, 1 / world unit, along the photograph's axis; 0 in the sky; kUnknownDepth where the
                        // photograph is masked, or its depth costs more than where no source sees it
  Image8 sky;           // 255 where infinity explains the picture (sky.h), else 0
  float level = 0;      // ρ from one level of the sweep to the next
};

/// Whether infinity is among what most photographs see: then those that look up at roofs may see the sky, too. By
/// photograph what sweepRange takes; those without tracks do not count.
bool mostReachInfinity(std::vector<std::vector<double>> trackInverseDepths);

/// Inverse depths along a photograph's axis between which it is swept.
struct SweepRange {
  double far = 0, near = 0;  // 0 <= far < near; 0: infinity
};

/// To well before the nearest tracks; from infinity where the farthest are deep enough, or where `fromInfinity` says
/// so. In steps of an eighth of an octave, so that a photograph that adds a few tracks changes no other one's depth.
/// `trackInverseDepths`: of what the photograph sees; one at least, all positive.
SweepRange sweepRange(std::vector<double> trackInverseDepths, bool fromInfinity = false);

/// `photograph` and `sources` at about half their size, their masks widened by kSweptWindow. Precondition: at least one
/// source.
SweptDepth sweptDepth(const SweepView& photograph, std::span<const SweepView> sources, SweepRange range);
/// Memory that it takes, at most: costs and their sums at all levels, sources and what they show at one.
inline constexpr double kSweptBytesPerPixel = 700;
inline constexpr int kSweptWindow = 3;  // px: the window's radius, and one of interpolation

}  // namespace ibr
