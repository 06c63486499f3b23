// SPDX-License-Identifier: Apache-2.0
#include "author/video/frame_measure.h"

#include <algorithm>
#include <deque>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <utility>

#include "author/pixels/cv_view.h"

namespace ibr {
namespace {

constexpr int kMaxPoints = 400, kWindow = 21, kLevels = 4;
constexpr double kMinDistance = 0.03;  // between points, of the longer side
constexpr float kBlurred = 0.6f;       // sharpness below which a frame is blurred
constexpr float kReturnPx = 0.7f;      // a point that is tracked back to where it came from is kept

std::array<float, 4> detailOf(const cv::Mat& grey) {
  cv::Mat smooth;
  cv::GaussianBlur(grey, smooth, {3, 3}, 0.8);  // noise is no detail
  const auto difference = [&](int dx, int dy) {
    const int width = smooth.cols - std::abs(dx), height = smooth.rows - dy;
    const cv::Mat a = smooth(cv::Rect(std::max(0, -dx), 0, width, height));
    const cv::Mat b = smooth(cv::Rect(std::max(0, dx), dy, width, height));
    cv::Mat d;
    cv::absdiff(a, b, d);
    return float(d.dot(d) / double(d.total()));
  };
  return {difference(2, 0), difference(0, 2), difference(2, 2), difference(-2, 2)};
}

}  // namespace

struct FrameMeasurer::State {
  std::size_t reach = 2;                     // number of frames in half a second
  std::deque<std::array<float, 4>> details;  // of the last frames
  std::vector<cv::Mat> before;               // pyramid of the last sharp frame
  std::vector<cv::Point2f> points;
  std::vector<std::uint32_t> ids;
  std::uint32_t next = 0;

  bool isBlurred(const std::array<float, 4>& detail) {
    std::array<float, 4> most{};
    for (const std::array<float, 4>& other : details)
      for (std::size_t d = 0; d < 4; ++d) most[d] = std::max(most[d], other[d]);
    details.push_back(detail);
    if (details.size() > reach) details.pop_front();
    for (std::size_t d = 0; d < 4; ++d)
      if (detail[d] < kBlurred * kBlurred * most[d]) return true;
    return false;
  }

  void track(const std::vector<cv::Mat>& now) {
    if (before.empty() || points.empty()) return;
    std::vector<cv::Point2f> moved, back;
    std::vector<std::uint8_t> found, returned;
    std::vector<float> errors;
    const cv::Size window(kWindow, kWindow);
    cv::calcOpticalFlowPyrLK(before, now, points, moved, found, errors, window, kLevels - 1);
    cv::calcOpticalFlowPyrLK(now, before, moved, back, returned, errors, window, kLevels - 1);
    const cv::Rect2f inside(1, 1, float(now[0].cols - 2), float(now[0].rows - 2));
    std::size_t kept = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const cv::Point2f d = back[i] - points[i];
      if (!found[i] || !returned[i] || !inside.contains(moved[i]) || d.dot(d) > kReturnPx * kReturnPx) continue;
      points[kept] = moved[i];
      ids[kept++] = ids[i];
    }
    points.resize(kept);
    ids.resize(kept);
  }

  // Adds corners away from the points there are.
  void add(const cv::Mat& grey) {
    const double distance = kMinDistance * std::max(grey.cols, grey.rows);
    cv::Mat free(grey.size(), CV_8U, cv::Scalar(255));
    for (const cv::Point2f& p : points) cv::circle(free, p, int(distance), cv::Scalar(0), cv::FILLED);
    const int wanted = kMaxPoints - int(points.size());
    if (wanted < kMaxPoints / 8) return;
    std::vector<cv::Point2f> corners;
    cv::goodFeaturesToTrack(grey, corners, wanted, 0.005, distance, free);
    for (const cv::Point2f& corner : corners) {
      points.push_back(corner);
      ids.push_back(next++);
    }
  }
};

FrameMeasurer::FrameMeasurer(double framesPerSecond) : state_(std::make_unique<State>()) {
  state_->reach = std::max<std::size_t>(2, std::size_t(0.5 * framesPerSecond));
}
FrameMeasurer::~FrameMeasurer() = default;

FrameMeasure FrameMeasurer::measure(const Image8& frame) {
  const cv::Mat grey = cvView(frame);
  FrameMeasure measure{detailOf(grey), {}};
  if (state_->isBlurred(measure.detail)) return measure;
  std::vector<cv::Mat> pyramid;
  constexpr bool kCopies = false;  // else the first level would refer to the caller's rows
  cv::buildOpticalFlowPyramid(grey, pyramid, cv::Size(kWindow, kWindow), kLevels - 1, true, cv::BORDER_REFLECT_101,
                              cv::BORDER_CONSTANT, kCopies);
  state_->track(pyramid);
  state_->add(grey);
  state_->before = std::move(pyramid);
  for (std::size_t i = 0; i < state_->points.size(); ++i)
    measure.points.push_back({state_->ids[i], state_->points[i].x, state_->points[i].y});
  return measure;
}

}  // namespace ibr
