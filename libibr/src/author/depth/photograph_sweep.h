// SPDX-License-Identifier: Apache-2.0
// Depth of a photograph from many others: plane sweep in the photograph's own image, then semi-global matching.
//
//   cost(pixel, ρ) = mean of c over the better half of the sources that see the pixel, where c = 1 − ZNCC of 5×5
//                    windows; with one source 0.5 c + 0.35, with none 0.78; c = 1 is 127.5 in the cost volume
//
// Only the better half counts, because the surface may be occluded in the other sources. ρ has even steps of about one
// pixel in the median source, and reaches beyond the nearest tracks. The first ρ is 0 (infinity), unless all tracks
// are about equally far and most photographs see nothing farther. Sources that move by more pixels a step are
// downsampled.
#pragma once

#include <span>
#include <vector>

#include "author/sweep/window_correlation.h"
#include "ibr/image.h"

namespace ibr {

/// Maps of one channel each, of the photograph's size.
struct SweptDepth {
  ImageF inverseDepth;  // ρ, 1 / world unit, along the photograph's axis; 0 in the sky; kUnknownDepth where the
                        // photograph is masked, or the cost reaches that of pixels without a source
  Image8 sky;           // 255 where infinity explains the image (sky.h), else 0
  float level = 0;      // step of ρ between two levels of the sweep
};

/// True if most photographs' tracks reach infinity; photographs without such tracks, e.g. views of roofs, may then see
/// the sky too. Takes sweepRange's input for each photograph; those without tracks do not count.
bool mostReachInfinity(std::vector<std::vector<double>> trackInverseDepths);

/// Range of inverse depths along a photograph's axis for the sweep, 1 / world unit.
struct SweepRange {
  double far = 0, near = 0;  // 0 <= far < near; 0: infinity
};

/// Range that reaches beyond the nearest tracks. Starts at infinity if the farthest tracks are deep enough or
/// `fromInfinity` is set. Limits are rounded to an eighth of an octave, so that a few new tracks rarely change other
/// photographs' depth. `trackInverseDepths`: of the photograph's tracks; at least one, all positive.
SweepRange sweepRange(std::vector<double> trackInverseDepths, bool fromInfinity = false);

/// Number of levels of the sweep, for cameras of the swept sizes.
int sweepLevelCount(const Camera& photograph, std::span<const Camera> sources, SweepRange range);

/// `photograph` and `sources`: at about half their size, with masks widened by kSweptWindow. Precondition: at least one
/// source.
SweptDepth sweptDepth(const SweepView& photograph, std::span<const SweepView> sources, SweepRange range);
/// Peak memory, bytes per pixel: costs and their sums at all levels, sources, and warped sources at one level.
inline constexpr double kSweptBytesPerPixel = 700;
inline constexpr int kSweptWindow = 3;  // px: the window's radius, plus 1 for interpolation

}  // namespace ibr
