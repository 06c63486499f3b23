// SPDX-License-Identifier: Apache-2.0
// How unlike its surroundings something looks: how far its small patches are from the nearest ones around (exemplars,
// as Criminisi, Pérez & Toyama 2004 fill holes with). Who stands before a wall is not to be found beside himself, the
// wall that he hides is: of two pictures that differ the one that shows the place without him is told so.
#pragma once

#include <opencv2/core.hpp>
#include <span>

namespace ibr {

/// Root mean square of the colours' difference between the patch of 5×5 px around each pixel of `where` (8 bits, not
/// 0) and the nearest one of those around pixels of `around` in any of `exemplars`, some thousand of them at most,
/// evenly taken; 0 elsewhere, and everywhere where there are none. All pictures: float, 3 channels, equal sizes.
cv::Mat unfamiliarity(const cv::Mat& picture, const cv::Mat& where, std::span<const cv::Mat> exemplars,
                      const cv::Mat& around);

}  // namespace ibr
