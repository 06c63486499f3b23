// SPDX-License-Identifier: Apache-2.0
// Scores of a rendered view against a photograph of the same view, as `ibr eval` reports them. All functions are pure.
//
// A rendered view is RGBA with AlphaContent::tier: alpha 0 marks holes, which are black. Metrics: ibr/metrics.h.
#pragma once

#include <array>
#include <limits>

#include "ibr/export.h"
#include "ibr/image.h"
#include "ibr/metrics.h"

namespace ibr {

/// Scores of a view. NaN: undefined, or not measured. Shares: 0 to 1, of the pixels that count.
struct ViewScores {
  static constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();  // value of a score without a value

  // psnr: PSNR of all pixels, dB; ssim: SSIM of all pixels, up to 1; flip: FLIP of all pixels, 0 to 1
  double psnr = kUndefined, ssim = kUndefined, flip = kUndefined;
  // Shares. coverage: drawn pixels; coverageTier0: pixels of tier 0; coverageTier2: pixels of tier 2
  double coverage = kUndefined, coverageTier0 = kUndefined, coverageTier2 = kUndefined;
  // psnrCovered: PSNR of drawn pixels, dB; ssimCovered: SSIM of drawn pixels, up to 1
  double psnrCovered = kUndefined, ssimCovered = kUndefined;
  double psnrGain = kUndefined, psnrCoveredGain = kUndefined;  // psnr and psnrCovered after gainFitted, dB
  double msSsim = kUndefined;                                  // MS-SSIM of the whole image; not measured with `used`
  double detailEnergy = kUndefined, detailCorrelation = kUndefined;  // Detail of drawn pixels
  double tornTiles = kUndefined;                                     // share of torn tiles; not measured with `used`
  WorstTile worstTile{0, 0, -1};  // tile with the largest error; not measured with `used`
};

/// Scores a view. `fitGain`: also measures psnrGain and psnrCoveredGain. `used`: mask of the pixels that count, one
/// channel; empty: all count. Throws Error{invalidInput} for other sizes or numbers of channels.
IBR_API ViewScores scoreView(const Image8& prediction, const Image8& truth, bool fitGain = false,
                             const Image8& used = {});

/// Returns a mask: 255 where alpha is not 0, else 0; one channel. Precondition: 4 channels.
IBR_API Image8 coverOf(const Image8& prediction);

/// Returns the shares of the pixels of tiers 0 to 3. Precondition: 4 channels.
IBR_API std::array<double, 4> tierShares(const Image8& prediction);

/// Returns the image (RGB) with each channel multiplied, in linear light, by one gain: the median over the mask of
/// truth over image, without clipped pixels. The gain removes the overall exposure, which is arbitrary, but keeps
/// differences within the image. Precondition: equal sizes.
IBR_API Image8 gainFitted(const Image8& picture, const Image8& truth, const Image8& mask);

}  // namespace ibr
