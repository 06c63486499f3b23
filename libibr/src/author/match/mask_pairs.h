// SPDX-License-Identifier: Apache-2.0
// Combines the pairwise agreement of a cell's members, some of which are masked: pairs with a masked member do not
// count, and at least one pair must count.
#pragma once

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <span>
#include <vector>

#include "author/match/match.h"
#include "author/pixels/cv_view.h"

namespace ibr {

class MaskPairs {
 public:
  /// `position`: for each member, its pixel position of each pixel of the frame. Both may be destroyed afterwards.
  MaskPairs(std::span<const MatchView> views, std::span<const ImageF> position) {
    for (std::size_t i = 0; i < views.size(); ++i) {
      cv::Mat corner, value, &used = used_.emplace_back();
      if (i == 0) all_ = cv::Mat(position[i].height, position[i].width, CV_8U, cv::Scalar(255));
      if (views[i].mask.empty()) {
        used = cv::Mat(all_.size(), CV_8U, cv::Scalar(255));
        continue;
      }
      cv::subtract(cvView(position[i]), cv::Scalar(0.5, 0.5), corner);
      cv::remap(cvView(views[i].mask), value, corner, cv::noArray(), cv::INTER_NEAREST, cv::BORDER_REPLICATE);
      used = value > 0;
    }
    any_ = cv::Mat(all_.size(), CV_8U, cv::Scalar(0));
  }

  /// 255 where neither is masked.
  cv::Mat used(std::size_t i, std::size_t j) const { return used_[i] & used_[j]; }

  void add(std::size_t i, std::size_t j, const cv::Mat& agreed) {
    const cv::Mat both = used(i, j);
    all_ = all_ & (agreed | ~both);
    any_ |= agreed & both;
  }

  /// 255 where all pairs that count agree, and at least one counts.
  cv::Mat good() const { return all_ & any_; }

 private:
  std::vector<cv::Mat> used_;
  cv::Mat all_, any_;
};

}  // namespace ibr
