// SPDX-License-Identifier: Apache-2.0
#include "author/match/match_flow.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "author/features/features.h"
#include "author/match/mask_pairs.h"
#include "author/match/mesh_warp.h"
#include "author/match/position_depth.h"
#include "author/photographs/masks.h"
#include "author/pixels/cv_view.h"
#include "author/sweep/window_agreement.h"
#include "ibr/author/photographs.h"

namespace ibr {
namespace {

constexpr int kMaxFeatures = 5000;
constexpr double kMaxDescriptorRatio = 0.85;
constexpr int kRounds = 2;
constexpr int kMinSidePx = 32;                 // px: smaller images do not suit the flow's pyramid
constexpr double kMaxForwardBackwardPx = 1.0;  // maximum forward-backward error, px
constexpr double kMaxCyclePx = 1.5;            // maximum error over a cycle of three members, px

// Samples `picture` at the map's positions; beyond its border the edge is repeated.
cv::Mat sampledAt(const cv::Mat& picture, const ImageF& map) {
  cv::Mat corner, result;
  cv::subtract(cvView(map), cv::Scalar(0.5, 0.5), corner);
  cv::remap(picture, result, corner, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return result;
}

// Composes two maps: first `first`, then `then`.
cv::Mat chained(const ImageF& first, const ImageF& then) {
  return sampledAt(cvView(then), first);
}

cv::Mat insideOf(const ImageF& map, const Image8& picture) {
  cv::Mat result;
  // The outer half pixel is left out: there, bilinear samples would repeat the edge.
  cv::inRange(cvView(map), cv::Scalar(0.5, 0.5), cv::Scalar(picture.width - 0.5, picture.height - 0.5), result);
  return result;
}

cv::Mat nearerThan(const cv::Mat& a, const cv::Mat& b, double limit) {
  const cv::Mat off = a - b;
  cv::Mat parts[2];
  cv::split(off, parts);
  return parts[0].mul(parts[0]) + parts[1].mul(parts[1]) < limit * limit;
}

class FlowMatcher {
 public:
  explicit FlowMatcher(std::span<const MatchView> views) : views_(views), d_(views.size()) {
    for (const MatchView& v : views) {
      features_.push_back(detectFeatures(grey_.emplace_back(toGrey(fillMasked(v.picture, v.mask))), kMaxFeatures));
    }
    const Image8& first = grey_[0];
    match_.frame = views[0].camera;
    match_.good = Image8(first.width, first.height, 1);
    match_.seen.assign(d_, Image8(first.width, first.height, 1));
    match_.refined = true;
    match_.depthKnown = false;
  }

  DenseMatch run() {
    for (std::size_t i = 0; i < d_; ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const std::vector<FeatureMatch> matches = mutualMatches(features_[j], features_[i], kMaxDescriptorRatio);
        PointPairs there, back;
        for (const FeatureMatch& m : matches) {
          there.from.push_back(features_[j].at[m.a]);
          there.to.push_back(features_[i].at[m.b]);
        }
        back.from = there.to;
        back.to = there.from;
        map_[j][i] = pairMap(j, i, there);
        map_[i][j] = pairMap(i, j, back);
      }
    gate();
    std::vector<Camera> cameras;
    for (const MatchView& v : views_) cameras.push_back(v.camera);
    depthFromPositions(match_, cameras);
    return std::move(match_);
  }

 private:
  // Maps each pixel of photograph i to its position in j.
  ImageF pairMap(std::size_t i, std::size_t j, const PointPairs& pairs) const {
    const Image8 &from = grey_[i], &to = grey_[j];
    ImageF map = meshWarp(pairs, {from.width, from.height}, {to.width, to.height});
    if (std::min(from.width, from.height) < kMinSidePx) return map;
    const auto flow = cv::DISOpticalFlow::create(cv::DISOpticalFlow::PRESET_MEDIUM);
    for (int round = 0; round < kRounds; ++round) {
      const cv::Mat warped = sampledAt(cvView(to), map);
      ImageF moved(from.width, from.height, 2);
      cv::Mat motion;
      flow->calc(cvView(from), warped, motion);
      for (int y = 0; y < from.height; ++y)
        for (int x = 0; x < from.width; ++x) {
          const cv::Vec2f m = motion.at<cv::Vec2f>(y, x);
          moved.pixel(x, y)[0] = float(x) + 0.5f + m[0];
          moved.pixel(x, y)[1] = float(y) + 0.5f + m[1];
        }
      const cv::Mat next = chained(moved, map);
      next.copyTo(cvView(map));
    }
    return map;
  }

  void gate() {
    const int width = grey_[0].width, height = grey_[0].height;
    ImageF& identity = match_.position.emplace_back(width, height, 2);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        identity.pixel(x, y)[0] = float(x) + 0.5f;
        identity.pixel(x, y)[1] = float(y) + 0.5f;
      }
    for (std::size_t i = 1; i < d_; ++i) match_.position.push_back(map_[0][i]);

    // Check forward and backward for each pair that the two members' matches of a pixel correspond to each other.
    MaskPairs pairs(views_, match_.position);
    std::vector<cv::Mat> inside, warped;
    for (std::size_t i = 0; i < d_; ++i) {
      inside.push_back(insideOf(match_.position[i], views_[i].picture));
      sampledAt(cvView(grey_[i]), match_.position[i]).convertTo(warped.emplace_back(), CV_32F);
    }
    for (std::size_t i = 0; i < d_; ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const double limit = j == 0 ? kMaxForwardBackwardPx : kMaxCyclePx;
        const cv::Mat back = nearerThan(chained(match_.position[i], map_[i][j]), cvView(match_.position[j]), limit);
        const cv::Mat there = nearerThan(chained(match_.position[j], map_[j][i]), cvView(match_.position[i]), limit);
        const cv::Mat sound = back & there & inside[i] & inside[j];
        const WindowAgreement found = agreement(warped[i], warped[j]);
        pairs.add(i, j, sound & found.alike);
        for (const std::size_t k : {i, j}) cvView(match_.seen[k]).setTo(1, sound & found.textured & pairs.used(i, j));
      }
    cvView(match_.good).setTo(1, pairs.good());
  }

  std::span<const MatchView> views_;
  std::size_t d_;
  std::vector<Image8> grey_;
  std::vector<Features> features_;
  ImageF map_[4][4];  // from one photograph to another
  DenseMatch match_;
};

}  // namespace

DenseMatch matchByFlow(std::span<const MatchView> views) {
  return FlowMatcher(views).run();
}

}  // namespace ibr
