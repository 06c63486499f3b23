// SPDX-License-Identifier: Apache-2.0
// Measures how unlike its surroundings an area looks: the distance of its patches from the nearest ones around
// (exemplars, as in Criminisi, Pérez & Toyama 2004). A wall behind a person continues beside the person, so its patches
// match; the person's patches do not. Of two differing images, the one with matching patches shows the background.
#pragma once

#include <opencv2/core.hpp>
#include <span>

namespace ibr {

/// Returns the RMS colour difference between the 5×5 patch around each pixel of `where` (8 bits, not 0) and the nearest
/// patch around pixels of `around` in any of `exemplars`. Per exemplar at most 2000 evenly spaced patches count; 0
/// elsewhere, and everywhere without exemplars. All images: float, 3 channels, equal sizes.
cv::Mat patchDissimilarity(const cv::Mat& picture, const cv::Mat& where, std::span<const cv::Mat> exemplars,
                           const cv::Mat& around);

}  // namespace ibr
