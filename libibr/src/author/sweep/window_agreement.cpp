// SPDX-License-Identifier: Apache-2.0
#include "author/sweep/window_agreement.h"

#include <opencv2/imgproc.hpp>

namespace ibr {
namespace {

constexpr double kMaxAlikeRms = 20.0;        // RMS difference of windows below which they count as alike, grey levels
constexpr double kMinTextureVariance = 9.0;  // grey²: minimum variance of a window with texture
constexpr double kNoiseVariance = 25.0;  // grey², added to variances and covariance, so that flat windows correlate

}  // namespace

WindowAgreement agreement(const cv::Mat& a, const cv::Mat& b, double correlation) {
  auto mean = [](const cv::Mat& m) {
    cv::Mat result;
    cv::blur(m, result, {7, 7}, {-1, -1}, cv::BORDER_REPLICATE);
    return result;
  };
  const cv::Mat meanA = mean(a), meanB = mean(b), offset = meanA - meanB;
  const cv::Mat ownA = cv::max(mean(a.mul(a)) - meanA.mul(meanA), 0);
  const cv::Mat ownB = cv::max(mean(b.mul(b)) - meanB.mul(meanB), 0);
  const cv::Mat shared = mean(a.mul(b)) - meanA.mul(meanB);
  cv::Mat ownRoot;
  cv::sqrt(ownA.mul(ownB), ownRoot);
  const cv::Mat textured = (cv::min(ownA, ownB) > kMinTextureVariance) & (shared > correlation * ownRoot);
  const cv::Mat varianceA = ownA + kNoiseVariance, varianceB = ownB + kNoiseVariance,
                covariance = shared + kNoiseVariance;
  cv::Mat root;
  cv::sqrt(varianceA.mul(varianceB), root);
  const cv::Mat square = varianceA + varianceB - 2 * covariance + offset.mul(offset);
  return {(covariance > correlation * root) | (square < kMaxAlikeRms * kMaxAlikeRms), textured};
}

}  // namespace ibr
