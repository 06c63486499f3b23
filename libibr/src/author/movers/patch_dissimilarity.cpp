// SPDX-License-Identifier: Apache-2.0
#include "author/movers/patch_dissimilarity.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace ibr {
namespace {

constexpr int kRadius = 2;                         // of a patch, px
constexpr int kStep = 2;                           // minimum distance of patches that are compared, px
constexpr double kMaxComparedPatches = 4000;       // approximate maximum number of compared patches
constexpr std::size_t kMaxExemplarPatches = 2000;  // maximum number from each image
constexpr int kBlock = 512;                        // patches compared in one matrix product

std::vector<cv::Point> pixelsOf(const cv::Mat& where, int step) {
  std::vector<cv::Point> pixels;
  for (int y = kRadius; y < where.rows - kRadius; y += step)
    for (int x = kRadius; x < where.cols - kRadius; x += step)
      if (where.at<std::uint8_t>(y, x)) pixels.emplace_back(x, y);
  return pixels;
}

std::vector<cv::Point> thinned(const std::vector<cv::Point>& pixels, std::size_t most) {
  if (pixels.size() <= most) return pixels;
  std::vector<cv::Point> some;
  for (std::size_t i = 0; i < most; ++i) some.push_back(pixels[i * pixels.size() / most]);
  return some;
}

// One patch a row.
cv::Mat patches(const cv::Mat& picture, const cv::Point* pixels, std::size_t count) {
  constexpr int kSide = 2 * kRadius + 1;
  cv::Mat rows(int(count), kSide * kSide * 3, CV_32F);
  for (std::size_t i = 0; i < count; ++i) {
    const cv::Rect at(pixels[i].x - kRadius, pixels[i].y - kRadius, kSide, kSide);
    cv::Mat row = rows.row(int(i)).reshape(3, kSide);
    picture(at).copyTo(row);
  }
  return rows;
}

cv::Mat squares(const cv::Mat& rows) {
  cv::Mat sums;
  cv::reduce(rows.mul(rows), sums, 1, cv::REDUCE_SUM);
  return sums;
}

}  // namespace

cv::Mat patchDissimilarity(const cv::Mat& picture, const cv::Mat& where, std::span<const cv::Mat> exemplars,
                           const cv::Mat& around) {
  cv::Mat result(picture.size(), CV_32F, cv::Scalar(0));
  const int step = std::max(kStep, int(std::ceil(std::sqrt(cv::countNonZero(where) / kMaxComparedPatches))));
  const std::vector<cv::Point> pool = thinned(pixelsOf(around, 1), kMaxExemplarPatches), wanted = pixelsOf(where, step);
  if (pool.empty() || exemplars.empty()) return result;
  cv::Mat known;
  for (const cv::Mat& exemplar : exemplars) known.push_back(patches(exemplar, pool.data(), pool.size()));
  const cv::Mat lengths = squares(known).t();
  for (std::size_t first = 0; first < wanted.size(); first += kBlock) {
    const std::size_t count = std::min<std::size_t>(kBlock, wanted.size() - first);
    const cv::Mat queries = patches(picture, &wanted[first], count);
    cv::Mat distances, nearest;
    cv::gemm(queries, known, -2, cv::Mat(), 0, distances, cv::GEMM_2_T);
    for (int i = 0; i < distances.rows; ++i) distances.row(i) += lengths;
    cv::reduce(distances, nearest, 1, cv::REDUCE_MIN);
    nearest += squares(queries);
    for (std::size_t i = 0; i < count; ++i) {
      const float value = std::sqrt(std::max(nearest.at<float>(int(i)), 0.0f) / float(known.cols));
      const cv::Point at = wanted[first + i];
      result(cv::Rect(at.x, at.y, step, step) & cv::Rect({}, result.size())).setTo(double(value));
    }
  }
  result.setTo(0, where == 0);
  return result;
}

}  // namespace ibr
