// SPDX-License-Identifier: Apache-2.0
#include "author/movers/grown_region.h"

#include <opencv2/imgproc.hpp>

#include "author/movers/disc.h"

namespace ibr {

cv::Mat grownRegion(const cv::Mat& region, const cv::Mat& colour, const cv::Mat& unseen, int outlinePx) {
  cv::Mat result = region.clone();
  const cv::Rect core = cv::boundingRect(region), whole({}, region.size());
  const cv::Rect box = cv::Rect(core.x - core.width / 2, core.y - core.height, 2 * core.width, 3 * core.height) & whole;
  const cv::Mat here = region(box), hidden = unseen(box);
  cv::Mat near, fate(box.size(), CV_8U, cv::Scalar(cv::GC_BGD));
  cv::dilate(here, near, disc(outlinePx));
  if (cv::countNonZero(hidden & near) < outlinePx) return result;
  fate.setTo(cv::GC_PR_BGD, hidden | near);
  fate.setTo(cv::GC_FGD, here);
  if (cv::countNonZero(fate == cv::GC_BGD) < outlinePx * outlinePx) return result;
  cv::Mat colours, background, foreground, label;
  colour(box).convertTo(colours, CV_8U);
  cv::theRNG().state = 1;  // the same result on any thread
  cv::grabCut(colours, fate, {}, background, foreground, 3, cv::GC_INIT_WITH_MASK);
  const cv::Mat grown = (fate == cv::GC_FGD) | ((fate == cv::GC_PR_FGD) & (hidden | near));
  const int parts = cv::connectedComponents(grown, label);
  for (int p = 1; p < parts; ++p)
    if (cv::countNonZero((label == p) & here) > 0) result(box).setTo(255, label == p);
  return result;
}

}  // namespace ibr
