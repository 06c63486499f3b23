// SPDX-License-Identifier: Apache-2.0
// Finds objects that moved while a scene was photographed: people, cars. They appear in one photograph only.
//
//   1. depth from the photograph's sweep (photograph_sweep.h), kept where another photograph looks alike at that depth;
//      elsewhere completed from around (complete_depth.h): the depth of the background, not of a person
//   2. the others are warped to the photograph through that depth. Two photographs differ at a pixel if a colour of one
//      lies outside the range of the other's colours around it, after a gain for each channel: misalignment of two
//      pixels makes no difference
//   3. regions that differ from all other photographs that see them, with matching surroundings. Small and
//      thin regions are left out, and also regions of which a share matches another photograph at any depth: such
//      regions are static, and their depth was wrong
//   4. the owner of a region: a hidden wall continues beside the region, a person does not; the photograph with
//      unmatched patches (patch_dissimilarity.h) shows the moving object. Parts of a region may have different owners
//
// The final decision, and the masks, are made between all photographs (settle_movers.h).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "author/match/match.h"
#include "ibr/image.h"

namespace ibr {

/// Lengths in px of the view at half its size, differences in 8-bit levels. Chosen by looking at masks of the bundled
/// cathedral and lane; libibr/docs/quality.md has what other photographs give.
struct MoverParameters {
  int maskMarginPx = 2;          // width by which given masks are widened
  int misalignmentPx = 2;        // of two photographs, that makes no difference
  int differenceWindowPx = 3;    // side of the window that averages differences
  int minDifference = 10;        // of a region's pixels …
  int minCoreDifference = 24;    // … and of its core
  double minCoreShare = 0.2;     // of a region's area
  double minMatchRadiusPx = 3;   // of an area that looks alike; a smaller one is chance
  double minCorrelation = 0.75;  // of windows that look alike at a tried depth
  int depthLevels = 96;          // tried depths, from infinity to the nearest one
  double minPatchRadiusPx = 3;   // of an area that looks alike at a tried depth
  double maxStaticShare = 0.1;   // of a region that looks alike at tried depths: people .00 to .06, static mostly > .2
  double maxThinWidth = 0.003;   // of an edge, share of the image's width
  double minArea = 0.001;        // of a region, share of the image's area
  double maxArea = 0.25;         // upper limit of one region and of all together; above it regions are dropped
  double minAgreement = 0.68;    // share of a region's surroundings that another photograph must show alike
  double minKnownShare = 0.15;   // share of the surroundings with measured depth
  int minMarginPx = 16;          // around a region, in which matching patches are searched
  int minMarginMatches = 200;    // pixels in that margin that look alike
  double minPatchRatio = 1.35;   // of a moving object's patch distance to that of the background …
  double patchNoise = 3;         // … plus this difference
  double minDecidedShare = 0.3;  // of a part, pixels whose owner is decided
  double minSeenShare = 0.5;     // of a part, pixels that another photograph sees
  int outlinePx = 5;             // band on both sides of a region's outline
};

enum class RegionOwner : std::uint8_t { own, unsure, another };

/// A pixel of the view at half its size, and the inverse depth of its static background along the view's axis.
struct DifferingPixel {
  std::uint16_t x = 0, y = 0;
  float inverseDepth = 0;
};

struct DifferingRegion {
  RegionOwner owner = RegionOwner::unsure;
  std::uint32_t other = 0;  // RegionOwner::another: index in `others` of the region's owner
  std::vector<DifferingPixel> pixels;
};

/// Regions of a view at half its size; regions of equal owner do not overlap. They cover at most a quarter of the view.
struct DifferingRegions {
  int width = 0, height = 0;
  std::vector<DifferingRegion> regions;
  ImageF depth;  // inverse depth of static surfaces at every kDepthStep-th pixel
};

inline constexpr int kDepthStep = 4;

/// `others`: at least one photograph that shows the same surfaces, pinholes like `view`. `depth`: inverse, along the
/// view's axis, at any size; kUnknownDepth where unknown.
DifferingRegions differingRegions(const MatchView& view, std::span<const MatchView> others, const ImageF& depth,
                                  const MoverParameters& parameters = {});

}  // namespace ibr
