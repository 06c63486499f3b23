// SPDX-License-Identifier: Apache-2.0
// Image metrics. Two images must have equal size and 3 or more channels; the first three are used. A mask must have the
// images' size and 1 channel; nonzero pixels count, without a mask all do. Otherwise functions throw
// Error{invalidInput}. Thread-safe.
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "ibr/export.h"
#include "ibr/image.h"

namespace ibr {

/// Peak signal-to-noise ratio in dB over R, G, B of 8-bit display-encoded values, of the pixels that count. +infinity
/// for equal images; NaN if no pixel counts.
IBR_API double psnr(const Image8& a, const Image8& b);
IBR_API double psnr(const Image8& a, const Image8& b, const Image8& mask);

/// Structural similarity (Wang et al. 2004): luma (Rec. 601), Gaussian window 11×11 with σ 1.5, K1 .01, K2 .03, mean
/// over all windows that lie inside the image and whose pixels all count. NaN if there is no such window.
IBR_API double ssim(const Image8& a, const Image8& b);
IBR_API double ssim(const Image8& a, const Image8& b, const Image8& mask);

/// Multi-scale structural similarity (Wang et al. 2003): five scales, each of means of 2×2 pixels of the previous one,
/// with the paper's weights. 1 for equal images, 0 if a scale's mean similarity is negative. NaN if a side is shorter
/// than 176 px (11 at the coarsest scale).
IBR_API double msSsim(const Image8& a, const Image8& b);

/// Default viewing distance of FLIP, pixels per degree of visual angle: a display of 0.7 m and 3840 px width, seen from
/// 0.7 m.
inline constexpr double kFlipPixelsPerDegree = 67;
/// LDR-FLIP (Andersson et al. 2020): perceived difference of two images that alternate on a display, by pixel, 0 (none)
/// to 1. pixelsPerDegree: of visual angle, 1 to 1000. Symmetric. The map has one channel. Throws Error{invalidInput}
/// also for empty images and other pixelsPerDegree.
IBR_API ImageF flipMap(const Image8& a, const Image8& b, double pixelsPerDegree = kFlipPixelsPerDegree);

/// Mean of flipMap.
IBR_API double flip(const Image8& a, const Image8& b, double pixelsPerDegree = kFlipPixelsPerDegree);

/// Mean CIE 1976 colour difference ΔE*ab (sRGB values, D65) over the pixels that count. NaN if no pixel counts.
IBR_API double deltaE(const Image8& a, const Image8& b, const Image8& mask);
/// Colour difference of two pixels. Precondition: 3 channels or more each.
IBR_API double deltaE(std::span<const std::uint8_t> a, std::span<const std::uint8_t> b);

/// Detail of an image compared with that of the truth, by luma differences d of neighbouring pixels that both count.
/// NaN if no such pixels differ in the truth.
struct Detail {
  double energy;       // Σ d² of the image / Σ d² of the truth; below 1: blur, above 1: ghost edges
  double correlation;  // Σ dd' / √(Σ d² Σ d'²), d' of the truth, -1 to 1; 1: all edges are in place
};
/// Computes the detail of an image over the pixels that count.
IBR_API Detail detail(const Image8& picture, const Image8& truth, const Image8& mask);

/// Share of an image's detail energy that remains when bilinear filtering samples the image between its pixels, mean
/// over 4 × 4 subpixel offsets. Photographs of the image's resolution, filtered likewise, can keep no more of it in a
/// view from elsewhere. NaN if no neighbouring pixels differ. Precondition: 3 channels or more.
IBR_API double sampledDetail(const Image8& picture);

/// Relative sharpness among images of the same subject: mean squared second difference, divided by the value of the
/// same image at an eighth of its size (`eighth`). Uses the direction of the smallest ratio, since a moving hand blurs
/// in one direction. The ratio falls with every blur of a pixel or more, and depends less on the subject than either
/// value. Uses the green or only channel. NaN if `eighth` has less than 8 px on a side.
IBR_API double sharpness(const Image8& picture, const Image8& eighth);

/// Side of the tiles of tornTiles() and worstTile(), px.
inline constexpr int kTileSidePx = 32;
/// Share of torn tiles among the image's 32 × 32 px tiles (smaller at the right and lower edge). A tile is torn if its
/// mean gradient energy exceeds three times the truth's by more than 4 (8-bit levels)². Gradient energy: squared luma
/// differences to the right and lower neighbours. NaN for empty images.
IBR_API double tornTiles(const Image8& picture, const Image8& truth);

/// The tile of kTileSidePx with the largest mean squared error over R, G, B.
struct WorstTile {
  int x = 0, y = 0;        // top-left corner, px
  double meanSquared = 0;  // error of the tile, (8-bit levels)²; -1 for empty images
};
/// Finds the tile with the largest error.
IBR_API WorstTile worstTile(const Image8& picture, const Image8& truth);

/// Absolute differences of two images over R, G, B, as image comparison tools report them.
struct Difference {
  int largest = 0;          // largest of all pixels and channels, 8-bit levels
  double meanAbsolute = 0;  // mean over pixels and channels, 8-bit levels
  double shareAbove = 0;    // share of the pixels whose largest channel difference exceeds `threshold`
};
/// Compares two images. `threshold`: 8-bit levels, for Difference::shareAbove.
IBR_API Difference difference(const Image8& a, const Image8& b, int threshold);

}  // namespace ibr
