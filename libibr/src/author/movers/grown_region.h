// SPDX-License-Identifier: Apache-2.0
// A moving object's region, extended to pixels of the same object that no comparison reaches.
#pragma once

#include <opencv2/core.hpp>

namespace ibr {

/// Extends a region with GrabCut (Rother, Kolmogorov & Blake 2004) into pixels that no other photograph shows, and into
/// a band of `outlinePx` around the region: a half-masked person looks worse than an unmasked one. Returns the region,
/// and the connected parts of the extension that touch it; the region alone if few unseen pixels lie beside it.
/// Deterministic. All images have one size. `colour`: RGB, float, 8-bit levels. `region`, `unseen` and the result:
/// 8 bits, 0 or 255. Precondition: `region` is not empty.
cv::Mat grownRegion(const cv::Mat& region, const cv::Mat& colour, const cv::Mat& unseen, int outlinePx);

}  // namespace ibr
