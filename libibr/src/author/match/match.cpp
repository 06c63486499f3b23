// SPDX-License-Identifier: Apache-2.0
#include "author/match/match.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "author/geometry/mean_frame.h"
#include "author/photographs/masks.h"
#include "author/pixels/cv_view.h"
#include "author/sweep/depth_clean.h"
#include "author/sweep/depth_edges.h"
#include "author/sweep/dominant_planes.h"
#include "author/sweep/plane_sweep.h"
#include "author/sweep/sgm.h"
#include "author/sweep/visibility.h"
#include "author/sweep/window_agreement.h"
#include "base/check.h"
#include "ibr/author/photographs.h"

namespace ibr {
namespace {

constexpr int kMaxSpeckleArea = 60;        // area of speckles that are removed, px at half resolution
constexpr float kSpeckleStep = 2.0f;       // of depth between speckle and surroundings, sweep levels
constexpr float kOcclusionLevels = 10.0f;  // in front of a pixel that a surface hides, sweep levels
constexpr double kMaxFlowPx = 3.0;         // maximum flow between warped members, px
constexpr int kSweepWindowRadius = 2;      // radius of the sweep's windows, px

Camera halved(const Camera& camera) {
  const Intrinsics& k = camera.intrinsics;
  return {resized(k, std::max(k.width / 2, 1), std::max(k.height / 2, 1)), camera.pose};
}

bool contains(const Image8& picture, glm::dvec2 pixel) {
  return pixel.x >= 0 && pixel.y >= 0 && pixel.x < picture.width && pixel.y < picture.height;
}

class Matcher {
 public:
  Matcher(std::span<const MatchView> views, const MatchOptions& options) : views_(views), options_(options) {
    for (const MatchView& v : views) {
      cameras_.push_back(v.camera);
      grey_.push_back(toGrey(v.picture));
    }
    match_.frame = meanFrame(cameras_);
    width_ = match_.frame.intrinsics.width;
    height_ = match_.frame.intrinsics.height;
    for (const Camera& camera : cameras_) maps_.push_back(frameToMember(match_.frame, camera));
  }

  DenseMatch run(std::span<const glm::dvec3> points) {
    findDepth(points);
    project();
    gate();
    if (options_.refine) refine();
    return std::move(match_);
  }

 private:
  std::size_t at(int x, int y) const { return std::size_t(y) * std::size_t(width_) + std::size_t(x); }

  void findDepth(std::span<const glm::dvec3> points) {
    const Camera frame = halved(match_.frame);
    std::vector<Camera> halves;
    for (const Camera& camera : cameras_) halves.push_back(halved(camera));
    std::vector<double> depths;
    for (const glm::dvec3& point : points)
      if (const double w = inverseDepth(match_.frame, point); w > 0 && std::isfinite(w)) depths.push_back(w);
    check(!depths.empty(), ErrorCode::invalidInput, "no point lies in front of the cell's members");
    const SweepLevels levels = sweepLevels(frame, halves, std::move(depths));
    match_.inverseDepthStep = float(levels.step);
    const ImageF half =
        options_.depths.empty() ? swept(frame, halves, levels, points) : depthFromMembers(frame, levels.step);
    match_.inverseDepth = enlarged(fitPlanes(half, match_.inverseDepthStep), width_, height_);
  }

  ImageF swept(const Camera& frame, std::span<const Camera> cameras, const SweepLevels& levels,
               std::span<const glm::dvec3> points) const {
    std::vector<SweepView> halves;
    for (std::size_t i = 0; i < views_.size(); ++i) {
      const int width = cameras[i].intrinsics.width, height = cameras[i].intrinsics.height;
      halves.push_back({cameras[i], ImageF(width, height, 1)});
      cv::Mat small, target = cvView(halves.back().grey);
      cv::resize(cvView(grey_[i]), small, {width, height}, 0, 0, cv::INTER_AREA);
      small.convertTo(target, CV_32F);
      halves.back().mask = widenedMask(resizedMask(views_[i].mask, width, height), kSweepWindowRadius);
    }
    std::vector<glm::dvec3> planes = dominantPlanes(match_.frame, cameras_, points);
    const glm::dvec3 toHalf(double(width_) / frame.intrinsics.width, double(height_) / frame.intrinsics.height, 1.0);
    for (glm::dvec3& plane : planes) plane *= toHalf;
    const CostVolume volume = planeSweep(frame, halves, levels, planes);
    ImageF level = semiGlobalMatch(volume).level;
    cleanDepth(level, kSpeckleStep, kMaxSpeckleArea);
    trimForegrounds(frame, halves, levels, volume.guide, level);
    for (float& l : level.values) l = float(levels.at(double(l)));
    return level;
  }

  ImageF depthFromMembers(const Camera& frame, double step) {
    FrameDepth depth = depthOfFrame(frame, options_.depths, step);
    cv::resize(cvView(depth.agree), agree_, {width_, height_}, 0, 0, cv::INTER_NEAREST);
    return std::move(depth.inverseDepth);
  }

  void project() {
    for (std::size_t i = 0; i < views_.size(); ++i) {
      ImageF& position = match_.position.emplace_back(width_, height_, 2);
      Image8& inside = inside_.emplace_back(width_, height_, 1);
      for (int y = 0; y < height_; ++y)
        for (int x = 0; x < width_; ++x) {
          const auto pixel = maps_[i]({x + 0.5, y + 0.5}, double(match_.inverseDepth.values[at(x, y)]));
          inside.values[at(x, y)] = pixel && contains(views_[i].picture, *pixel);
          position.values[2 * at(x, y)] = pixel ? float(pixel->x) : -1.0f;
          position.values[2 * at(x, y) + 1] = pixel ? float(pixel->y) : -1.0f;
        }
      cv::Mat corner, warped;
      cv::subtract(cvView(position), cv::Scalar(0.5, 0.5), corner);
      cv::remap(cvView(grey_[i]), warped, corner, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
      warped.convertTo(warped_.emplace_back(), CV_32F);
      cv::Mat& ignored = ignored_.emplace_back();
      if (views_[i].mask.empty()) continue;
      cv::remap(cvView(views_[i].mask), ignored, corner, cv::noArray(), cv::INTER_NEAREST, cv::BORDER_REPLICATE);
      ignored = ignored == 0;
    }
    fillMaskedPixels();
  }

  // Replaces masked pixels of a member by the mean of the others: windows beside the mask then contain nothing else,
  // and the optical flow has no false motion to follow.
  void fillMaskedPixels() {
    std::vector<cv::Mat> shown;
    for (std::size_t i = 0; i < views_.size(); ++i) {
      shown.push_back(warped_[i].clone());
      if (ignored_[i].empty()) continue;
      cv::Mat sum(height_, width_, CV_32F, cv::Scalar(0)), count = sum.clone();
      for (std::size_t j = 0; j < views_.size(); ++j) {
        if (j == i) continue;
        const cv::Mat used = usedBy(j);
        cv::add(sum, warped_[j], sum, used);
        cv::add(count, 1, count, used);
      }
      cv::Mat mean = sum / cv::max(count, 1);
      mean.copyTo(shown[i], ignored_[i] & (count > 0));
    }
    warped_ = std::move(shown);
  }

  cv::Mat usedBy(std::size_t i) const {
    return ignored_[i].empty() ? cv::Mat(height_, width_, CV_8U, cv::Scalar(255)) : cv::Mat(~ignored_[i]);
  }

  // Only surfaces that two members agree on may hide pixels: elsewhere the sweep's depth is a guess.
  void gate() {
    cv::Mat all(height_, width_, CV_8U, cv::Scalar(255)), any(height_, width_, CV_8U, cv::Scalar(0));
    match_.seen.assign(views_.size(), Image8(width_, height_, 1));
    for (std::size_t i = 0; i < views_.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const WindowAgreement found = agreement(warped_[i], warped_[j]);
        const cv::Mat inside = (cvView(inside_[i]) > 0) & (cvView(inside_[j]) > 0);
        const cv::Mat used = usedBy(i) & usedBy(j), agreed = found.alike & inside;
        all &= agreed | (~used & inside);
        any |= agreed & used;
        for (const std::size_t k : {i, j}) cvView(match_.seen[k]).setTo(1, found.textured & inside & used);
      }
    all &= any;
    for (std::size_t i = 0; i < views_.size() && !agree_.empty(); ++i) all &= ((agree_ & (1 << i)) > 0) | ~usedBy(i);
    Image8 solid(width_, height_, 1);
    cvView(solid).setTo(1, any);
    match_.good = Image8(width_, height_, 1);
    cvView(match_.good).setTo(1, all);
    for (std::size_t i = 0; i < views_.size(); ++i) {
      const Image8 visible = visibleFrom(maps_[i], match_.inverseDepth, solid, views_[i].picture.width,
                                         views_[i].picture.height, kOcclusionLevels * match_.inverseDepthStep);
      cvView(match_.good).setTo(0, cvView(visible) == 0);
      cvView(match_.seen[i]).setTo(0, cvView(visible) == 0);
    }
  }

  // Measures the remaining displacement between member 0 and each other member, both warped to the frame.
  void refine() {
    match_.refined = true;
    if (std::min(width_, height_) < 32) return;  // too small for the flow's pyramid
    const auto flow = cv::DISOpticalFlow::create(cv::DISOpticalFlow::PRESET_MEDIUM);
    cv::Mat first, other, residual;
    warped_[0].convertTo(first, CV_8U);
    for (std::size_t i = 1; i < views_.size(); ++i) {
      warped_[i].convertTo(other, CV_8U);
      flow->calc(first, other, residual);
      for (int y = 0; y < height_; ++y)
        for (int x = 0; x < width_; ++x) {
          std::uint8_t& good = match_.good.values[at(x, y)];
          if (!good) continue;
          const cv::Vec2f r = residual.at<cv::Vec2f>(y, x);
          const auto pixel =
              maps_[i]({x + 0.5 + double(r[0]), y + 0.5 + double(r[1])}, double(match_.inverseDepth.values[at(x, y)]));
          good = cv::norm(r) < kMaxFlowPx && pixel && contains(views_[i].picture, *pixel);
          if (!good) continue;
          match_.position[i].values[2 * at(x, y)] = float(pixel->x);
          match_.position[i].values[2 * at(x, y) + 1] = float(pixel->y);
        }
    }
  }

  std::span<const MatchView> views_;
  const MatchOptions& options_;
  int width_ = 0, height_ = 0;
  std::vector<Camera> cameras_;
  std::vector<FrameToMember> maps_;
  std::vector<Image8> grey_;      // source images
  std::vector<cv::Mat> warped_;   // members warped to the frame, float
  std::vector<cv::Mat> ignored_;  // 255 where the frame's pixel is masked in the member; empty without a mask
  std::vector<Image8> inside_;
  cv::Mat agree_;  // FrameDepth::agree; empty if the frame was swept
  DenseMatch match_;
};

}  // namespace

DenseMatch matchViews(std::span<const MatchView> views, std::span<const glm::dvec3> points,
                      const MatchOptions& options) {
  return Matcher(views, options).run(points);
}

}  // namespace ibr
