// SPDX-License-Identifier: Apache-2.0
// Comparisons of two RGB images of one size (float, 8-bit levels): exposure, windows of grey, colours. They tolerate
// different exposure or a small misalignment, which moving objects exceed.
#pragma once

#include <opencv2/core.hpp>

#include "author/sweep/window_agreement.h"

namespace ibr {

/// Compares windows of the images' grey values (window_agreement.h).
WindowAgreement greyAgreement(const cv::Mat& a, const cv::Mat& b, double correlation = kSameCorrelation);

/// Returns `b`, each channel scaled by the median ratio of `a` to `b`. Only pixels count where `where` (8 bits) is not
/// 0 and neither value is dark or saturated. A channel with fewer than 100 such pixels keeps its values.
cv::Mat exposureMatched(const cv::Mat& a, const cv::Mat& b, const cv::Mat& where);

/// Returns for each pixel the distance of `a` from the range of values of `b` within `misalignmentPx`, or the reverse:
/// the larger of both. Float, 8-bit levels: RMS over the channels, mean over a window of side `windowPx`.
cv::Mat colourDifference(const cv::Mat& a, const cv::Mat& b, int misalignmentPx, int windowPx);

}  // namespace ibr
