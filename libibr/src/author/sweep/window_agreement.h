// SPDX-License-Identifier: Apache-2.0
// Whether two pictures show the same, pixel by pixel, up to exposure.
#pragma once

#include <opencv2/core.hpp>

namespace ibr {

/// 8-bit masks, 255 where it holds.
struct WindowAgreement {
  cv::Mat alike;     // windows of 7×7 look the same up to gain and offset, or nearly so as they are
  cv::Mat textured;  // they have texture, and it is the same
};

/// Least correlation of 7×7 windows that look the same.
inline constexpr double kSameCorrelation = 0.5;

/// Of two grey pictures (float, 0 … 255) of one size.
WindowAgreement agreement(const cv::Mat& a, const cv::Mat& b, double correlation = kSameCorrelation);

}  // namespace ibr
