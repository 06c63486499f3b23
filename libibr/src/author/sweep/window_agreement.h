// SPDX-License-Identifier: Apache-2.0
// Compares two images window by window, up to exposure.
#pragma once

#include <opencv2/core.hpp>

namespace ibr {

/// 8-bit masks, 255 where true.
struct WindowAgreement {
  cv::Mat alike;     // 7×7 windows correlate (gain and offset free), or differ little as they are
  cv::Mat textured;  // both windows have texture, and their textures correlate
};

/// Minimum correlation of 7×7 windows that count as alike.
inline constexpr double kSameCorrelation = 0.5;

/// Compares two grey images (float, 0 … 255) of one size.
WindowAgreement agreement(const cv::Mat& a, const cv::Mat& b, double correlation = kSameCorrelation);

}  // namespace ibr
