// SPDX-License-Identifier: Apache-2.0
// Picture metrics. All take pictures of equal size with 3 or more channels (further channels are ignored) and throw
// Error{invalidInput} otherwise. Thread-safe.
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "ibr/image.h"

namespace ibr {

/// Peak signal-to-noise ratio in dB over R, G, B of 8-bit display-encoded values; +infinity for equal pictures.
/// With a mask (1 channel, nonzero = counts) only those pixels count; NaN where none does.
double psnr(const Image8& a, const Image8& b);
double psnr(const Image8& a, const Image8& b, const Image8& mask);

/// Structural similarity (Wang et al. 2004): luma (Rec. 601), Gaussian window 11×11 with σ 1.5, K1 .01, K2 .03, mean
/// over all windows that lie inside the picture. With a mask: over the windows that lie wholly inside it; NaN where
/// none does.
double ssim(const Image8& a, const Image8& b);
double ssim(const Image8& a, const Image8& b, const Image8& mask);

/// Multi-scale structural similarity (Wang et al. 2003): five scales, each of means of 2×2 pixels of the one before,
/// with the weights of the paper; 1 for equal pictures, 0 where a scale's pictures are opposites. NaN where a side is
/// shorter than 176 px (11 at the coarsest scale).
double msSsim(const Image8& a, const Image8& b);

/// LDR-FLIP (Andersson et al. 2020): how strong a difference is seen when the pictures alternate in one place, 0 (none)
/// to 1, a pixel; the eye sees `pixelsPerDegree` of them in a degree (1 to 1000; 67: a display of 0.7 m and 3840 px at
/// 0.7 m). Symmetric. The map has one channel. Throws Error{invalidInput} also for empty pictures.
inline constexpr double kFlipPixelsPerDegree = 67;
ImageF flipMap(const Image8& a, const Image8& b, double pixelsPerDegree = kFlipPixelsPerDegree);

/// The map's mean.
double flip(const Image8& a, const Image8& b, double pixelsPerDegree = kFlipPixelsPerDegree);

/// Mean CIE 1976 colour difference ΔE*ab (sRGB values, D65) over the pixels that count in a mask (1 channel, nonzero);
/// NaN where none does.
double deltaE(const Image8& a, const Image8& b, const Image8& mask);
/// Of two pixels. Precondition: 3 channels or more each.
double deltaE(std::span<const std::uint8_t> a, std::span<const std::uint8_t> b);

/// What a picture keeps of the truth's detail, over differences of luma between neighbouring pixels that both count in
/// the mask (1 channel, nonzero). NaN where no such pixels differ in the truth.
struct Detail {
  double energy;  // Σ d² of the picture / Σ d² of the truth: below 1 it is blurred, above 1 it has edges of ghosts
  double correlation;  // of both pictures' d (without means), -1 to 1: 1 where edges stand where they stood
};
Detail detail(const Image8& picture, const Image8& truth, const Image8& mask);

/// The energy that is left of a picture's detail where it is read between its pixels by bilinear filtering, mean over 4
/// × 4 places: what a photograph as fine as the picture can show of it from elsewhere. NaN where no neighbours differ.
double sampledDetail(const Image8& picture);

/// Share of the picture's 32 × 32 px tiles (those at the right and lower edge may be smaller) that are torn: their mean
/// gradient energy, the squared differences of luma to the right and lower neighbours, exceeds three times the truth's
/// by more than 4 levels². NaN for empty pictures.
inline constexpr int kTileSide = 32;  // px
double tornTiles(const Image8& picture, const Image8& truth);

/// The tile whose mean squared error over R, G, B is the largest.
struct WorstTile {
  int x = 0, y = 0;        // px of its upper left corner
  double meanSquared = 0;  // levels²
};
WorstTile worstTile(const Image8& picture, const Image8& truth);

/// Share of pixels whose largest channel difference exceeds each tolerance, as image comparison tools report it.
struct Difference {
  int largest = 0;          // levels
  double meanAbsolute = 0;  // levels, over pixels and channels
  double shareAbove = 0;    // of pixels whose largest channel difference exceeds `threshold`
};
Difference difference(const Image8& a, const Image8& b, int threshold);

}  // namespace ibr
