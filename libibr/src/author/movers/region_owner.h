// SPDX-License-Identifier: Apache-2.0
// The owner of a differing region: the photograph that shows a moving object there. A hidden wall continues beside the
// region, a moving object does not, so its patches match no patch around the region (patch_dissimilarity.h).
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "author/movers/movers.h"
#include "author/movers/warped_photograph.h"

namespace ibr {

/// Another photograph, warped to the view and matched to the view's exposure.
struct ComparedPhotograph {
  WarpedPhotograph warped;
  cv::Mat differs;  // colourDifference from the view
};

/// A view at half its size, and the data to judge its regions. All images have the view's size.
struct RegionEvidence {
  cv::Mat colour;                          // the view's: RGB, float, 8-bit levels
  cv::Mat known;                           // 8 bits, 255: depth was matched, not completed
  cv::Mat unseen;                          // 8 bits, 255: no other photograph shows the pixel
  std::vector<ComparedPhotograph> others;  // at least one
};

/// A region, or a part of it, with one owner.
struct OwnedPart {
  RegionOwner owner;
  std::uint32_t other;  // RegionOwner::another: index into RegionEvidence::others
  cv::Mat mask;         // 8 bits, 255: pixels of the part
  cv::Point corner;     // position of the mask's pixel (0, 0) in the view, px
};

/// Splits a region into parts of one owner each: the view's own parts first, extended to unseen pixels (grownRegion).
/// One part of the whole region is unsure if no owner is found; the result is empty if no other photograph can judge.
/// `region`, `differing`: 8 bits, of the view's size, 255 in this region and in all regions. `box`: the bounding
/// rectangle of `region`.
std::vector<OwnedPart> partsByOwner(const cv::Mat& region, cv::Rect box, const cv::Mat& differing,
                                    const RegionEvidence& evidence, const MoverParameters& parameters);

}  // namespace ibr
