// SPDX-License-Identifier: Apache-2.0
// A round structuring element for morphological operations.
#pragma once

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace ibr {

/// Returns a filled ellipse of side 2·r + 1, with r the rounded radius, px, and at least 1.
inline cv::Mat disc(double radiusPx) {
  const int r = std::max(1, int(std::lround(radiusPx)));
  return cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * r + 1, 2 * r + 1});
}

}  // namespace ibr
