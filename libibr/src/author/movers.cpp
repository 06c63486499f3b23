// SPDX-License-Identifier: Apache-2.0
#include "author/movers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "author/agreement.h"
#include "author/complete_depth.h"
#include "author/cv_view.h"
#include "author/depth_clean.h"
#include "author/depth_edges.h"
#include "author/dominant_planes.h"
#include "author/masks.h"
#include "author/mean_frame.h"
#include "author/photographs.h"
#include "author/plane_sweep.h"
#include "author/scene_depth.h"
#include "author/sgm.h"
#include "base/check.h"

namespace ibr {
namespace {

constexpr int kSpeckle = 60;          // px at half resolution
constexpr float kSpeckleStep = 2.0f;  // levels
constexpr int kSweepWindow = 2;       // px, radius of the sweep's windows
constexpr int kMisaligned = 2;        // px at half resolution that colours may be off
constexpr int kPatch = 3;             // px, side of what differs as a whole
constexpr int kSurely = 24;           // grey levels: a mover's core
constexpr int kPerhaps = 10;          // and what belongs to it
constexpr double kOdd = 8;            // grey levels nearer to what goes on from around that another one is
constexpr double kCore = 0.2;         // share of a region that is core, at least
constexpr double kLooksLike = 0.75;   // correlation that explains a pixel
constexpr double kExplained = 0.3;    // share of a region that makes it no mover
constexpr double kThin = 0.003;       // of the width: what is no wider is an edge
constexpr double kSmall = 0.0005;     // of the area
constexpr double kOutline = 1.7;      // times the other's contrast across the outline …
constexpr double kOutlineNoise = 5;   // … and grey levels more
constexpr double kSeen = 0.6;         // share of the outline that the other one must see
constexpr double kAgrees = 0.68;      // share of what it sees around that it must show alike
constexpr double kKnown = 0.15;       // share of that whose depth was not completed
constexpr double kWidened = 0.01;     // of the width
constexpr int kIsland = 3;            // px: what looks alike on less is chance
constexpr int kBand = 5;              // px at half resolution on both sides of an outline

cv::Mat disc(double radius) {
  const int r = std::max(1, int(std::lround(radius)));
  return cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * r + 1, 2 * r + 1});
}

cv::Mat grey(const cv::Mat& colour) {
  cv::Mat result;
  cv::cvtColor(colour, result, cv::COLOR_RGB2GRAY);
  return result;
}

// One photograph among others, at half the matched size.
struct Half {
  SweepView sweep;
  cv::Mat colour;  // float, 3 channels
  cv::Mat used;    // 255: inside the mask
};

Half halfOf(const MatchView& view) {
  const int width = std::max(view.picture.width / 2, 1), height = std::max(view.picture.height / 2, 1);
  Half half{{{resized(view.camera.intrinsics, width, height), view.camera.pose}, ImageF(width, height, 1)}, {}, {}};
  const Image8 small = shrunk(view.picture, width, height);
  cvView(small).convertTo(half.colour, CV_32F);
  grey(half.colour).copyTo(cvView(half.sweep.grey));
  half.sweep.mask = widenedMask(resizedMask(view.mask, width, height), kSweepWindow);
  half.used =
      half.sweep.mask.empty() ? cv::Mat(height, width, CV_8U, cv::Scalar(255)) : cvView(half.sweep.mask).clone();
  return half;
}

// Another photograph as the frame sees it through a depth.
struct Warped {
  cv::Mat colour, inside;  // 255: it is in its picture, and not masked
  cv::Mat differs;         // from the view, grey levels
};

class Judge {
 public:
  Judge(const MatchView& view, std::span<const MatchView> others, std::span<const glm::dvec3> points)
      : view_(halfOf(view)), frame_(view_.sweep.camera), points_(points) {
    for (const MatchView& other : others) others_.push_back(halfOf(other));
    width_ = frame_.intrinsics.width;
    height_ = frame_.intrinsics.height;
  }

  Image8 run() {
    const ImageF depth = knownDepth();
    for (const Half& other : others_) {
      Warped w = warped(other, depth);
      w.colour = alikeExposed(view_.colour, w.colour, looksLike(view_.colour, w.colour) & w.inside & view_.used);
      w.differs = difference(view_.colour, w.colour);
      warped_.push_back(std::move(w));
    }
    return moved(leastDifference());
  }

 private:
  // Inverse depth in the frame that the photographs agree on best.
  ImageF depthOf(std::span<const Half* const> halves) const {
    std::vector<SweepView> views;
    std::vector<Camera> cameras;
    for (const Half* half : halves) {
      views.push_back(half->sweep);
      cameras.push_back(half->sweep.camera);
    }
    std::vector<double> depths;
    for (const glm::dvec3& point : points_)
      if (const double w = inverseDepth(frame_, point); w > 0 && std::isfinite(w)) depths.push_back(w);
    check(!depths.empty(), ErrorCode::invalidInput, "no point lies in front of the photograph");
    const SweepLevels levels = sweepLevels(frame_, cameras, std::move(depths));
    const CostVolume volume = planeSweep(frame_, views, levels, dominantPlanes(frame_, cameras, points_));
    ImageF level = semiGlobalLevels(volume);
    cleanDepth(level, kSpeckleStep, kSpeckle);
    trimForegrounds(frame_, views, levels, volume.guide, level);
    for (float& l : level.values) l = float(levels.at(double(l)));
    return enlarged(fitPlanes(level, float(levels.step)), width_, height_);
  }

  Warped warped(const Half& other, const ImageF& depth) const {
    const FrameToMember map = frameToMember(frame_, other.sweep.camera);
    const Intrinsics& k = other.sweep.camera.intrinsics;
    cv::Mat at(height_, width_, CV_32FC2);
    Warped result{{}, cv::Mat(height_, width_, CV_8U, cv::Scalar(0))};
    for (int y = 0; y < height_; ++y)
      for (int x = 0; x < width_; ++x) {
        const auto pixel = map({x + 0.5, y + 0.5}, double(depth.pixel(x, y)[0]));
        const glm::dvec2 p = pixel.value_or(glm::dvec2(-1));
        at.at<cv::Vec2f>(y, x) = {float(p.x - 0.5), float(p.y - 0.5)};
        if (p.x < 1 || p.y < 1 || p.x > k.width - 1 || p.y > k.height - 1) continue;
        result.inside.at<std::uint8_t>(y, x) = other.used.at<std::uint8_t>(int(p.y), int(p.x));
      }
    cv::remap(other.colour, result.colour, at, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    return result;
  }

  static cv::Mat looksLike(const cv::Mat& a, const cv::Mat& b) {
    return agreement(grey(a), grey(b), kLooksLike).textured;
  }

  // Of each channel what makes `b` as bright as `a` where they look alike: the median ratio.
  static cv::Mat alikeExposed(const cv::Mat& a, const cv::Mat& b, const cv::Mat& where) {
    cv::Mat result = b.clone();
    std::array<std::vector<float>, 3> ratios;
    for (int y = 0; y < a.rows; ++y)
      for (int x = 0; x < a.cols; ++x) {
        if (!where.at<std::uint8_t>(y, x)) continue;
        const cv::Vec3f va = a.at<cv::Vec3f>(y, x), vb = b.at<cv::Vec3f>(y, x);
        for (int c = 0; c < 3; ++c)
          if (std::min(va[c], vb[c]) > 12 && std::max(va[c], vb[c]) < 250)
            ratios[std::size_t(c)].push_back(va[c] / vb[c]);
      }
    cv::Scalar gain(1, 1, 1);
    for (int c = 0; c < 3; ++c) {
      std::vector<float>& r = ratios[std::size_t(c)];
      if (r.size() < 100) continue;
      const auto middle = r.begin() + std::ptrdiff_t(r.size() / 2);
      std::nth_element(r.begin(), middle, r.end());
      gain[c] = double(*middle);
    }
    cv::multiply(result, gain, result);
    return result;
  }

  // How far `a` is outside the range of `b` around each pixel, and `b` outside that of `a`, grey levels: the larger.
  static cv::Mat difference(const cv::Mat& a, const cv::Mat& b) {
    const cv::Mat around = cv::getStructuringElement(cv::MORPH_RECT, {2 * kMisaligned + 1, 2 * kMisaligned + 1});
    const auto outside = [&](const cv::Mat& one, const cv::Mat& other) {
      cv::Mat high, low;
      cv::dilate(other, high, around);
      cv::erode(other, low, around);
      cv::Mat off = cv::max(one - high, 0) + cv::max(low - one, 0);
      std::array<cv::Mat, 3> channel;
      cv::split(off, channel.data());
      cv::Mat square = channel[0].mul(channel[0]) + channel[1].mul(channel[1]) + channel[2].mul(channel[2]), length;
      cv::sqrt(square / 3, length);
      cv::blur(length, length, {kPatch, kPatch});
      return length;
    };
    return cv::max(outside(a, b), outside(b, a));
  }

  // Where the view and another one look alike, the median of what they say; elsewhere completed.
  ImageF knownDepth() {
    std::vector<ImageF> maps;
    explained_ = cv::Mat(height_, width_, CV_8U, cv::Scalar(0));
    known_ = explained_.clone();
    for (const Half& other : others_) {
      const Half* const both[]{&view_, &other};
      ImageF depth = depthOf(both);
      const Warped w = warped(other, depth);
      cv::Mat alike = agreement(grey(view_.colour), grey(w.colour)).alike & w.inside & view_.used;
      explained_ |= looksLike(view_.colour, w.colour) & w.inside;
      cv::morphologyEx(alike, alike, cv::MORPH_OPEN, disc(kIsland));
      known_ |= alike;
      cvView(depth).setTo(kUnknownDepth, alike == 0);
      maps.push_back(std::move(depth));
    }
    Image8 colours(width_, height_, 3);
    cv::Mat to = cvView(colours);
    view_.colour.convertTo(to, CV_8U);
    return completeDepth(medianDepth(maps), colours);
  }

  // From those that see the pixel, grey levels; 0 where nobody does.
  cv::Mat leastDifference() const {
    cv::Mat least(height_, width_, CV_32F, cv::Scalar(255)), any(height_, width_, CV_8U, cv::Scalar(0));
    for (const Warped& w : warped_) {
      const cv::Mat smaller = cv::min(least, w.differs);
      smaller.copyTo(least, w.inside);
      any |= w.inside;
    }
    least.setTo(0, (any == 0) | (view_.used == 0));
    return least;
  }

  Image8 moved(const cv::Mat& differs) const {
    cv::Mat perhaps = differs >= kPerhaps;
    cv::morphologyEx(perhaps, perhaps, cv::MORPH_OPEN, disc(kThin * width_));
    cv::morphologyEx(perhaps, perhaps, cv::MORPH_CLOSE, disc(2 * kThin * width_));
    perhaps &= oddness(perhaps) > kOdd;
    cv::morphologyEx(perhaps, perhaps, cv::MORPH_OPEN, disc(kThin * width_));
    cv::morphologyEx(perhaps, perhaps, cv::MORPH_CLOSE, disc(2 * kThin * width_));
    cv::Mat label, stats, centre;
    const int regions = cv::connectedComponentsWithStats(perhaps, label, stats, centre);
    Image8 mask(width_, height_, 1, 255);
    cv::Mat result = cvView(mask);
    for (int r = 1; r < regions; ++r) {
      const cv::Rect box(stats.at<int>(r, cv::CC_STAT_LEFT), stats.at<int>(r, cv::CC_STAT_TOP),
                         stats.at<int>(r, cv::CC_STAT_WIDTH), stats.at<int>(r, cv::CC_STAT_HEIGHT));
      const double area = stats.at<int>(r, cv::CC_STAT_AREA);
      if (area < kSmall * width_ * height_) continue;
      const cv::Mat region = label == r;
      const double core = cv::countNonZero(region(box) & (differs(box) >= kSurely));
      const double known = cv::countNonZero(region(box) & explained_(box));
      if (core < kCore * area || known > kExplained * area || !isOddOne(region, box)) continue;
      result.setTo(0, region);
      goOn(region, box, result);
    }
    cv::erode(result, result, disc(kWidened * width_), {-1, -1}, 1, cv::BORDER_CONSTANT, cv::Scalar(255));
    return mask;
  }

  // How much farther the view's colours are from what goes on from around than another one's: the most, grey levels.
  // Somebody beside whom, or before whom, another one shows somebody else is told from him so.
  cv::Mat oddness(const cv::Mat& regions) const {
    cv::Mat around, most(height_, width_, CV_32F, cv::Scalar(0));
    cv::dilate(regions, around, disc(2));
    Image8 outside(width_, height_, 1), colours(width_, height_, 3);
    cvView(outside).setTo(255, around == 0);
    cv::Mat to = cvView(colours), background;
    view_.colour.convertTo(to, CV_8U);
    cv::cvtColor(cvView(withMask(colours, outside)), background, cv::COLOR_RGBA2RGB);
    background.convertTo(background, CV_32F);
    const auto away = [&](const cv::Mat& colour) {
      std::array<cv::Mat, 3> channel;
      cv::split(colour - background, channel.data());
      cv::Mat square = channel[0].mul(channel[0]) + channel[1].mul(channel[1]) + channel[2].mul(channel[2]), length;
      cv::sqrt(square / 3, length);
      cv::blur(length, length, {kBand, kBand});
      return length;
    };
    const cv::Mat own = away(view_.colour);
    for (const Warped& w : warped_) {
      const cv::Mat larger = cv::max(most, own - away(w.colour));
      larger.copyTo(most, w.inside);
    }
    return most;
  }

  // Whoever reaches into what nobody else sees goes on there as far as colours say (Rother, Kolmogorov & Blake 2004,
  // GrabCut): half of him would be worse than all.
  void goOn(const cv::Mat& region, cv::Rect box, cv::Mat& mask) const {
    const cv::Rect whole(0, 0, width_, height_);
    box = cv::Rect(box.x - box.width / 2, box.y - box.height, 2 * box.width, 3 * box.height) & whole;
    cv::Mat unseen(box.size(), CV_8U, cv::Scalar(255)), near, fate(box.size(), CV_8U, cv::Scalar(cv::GC_BGD));
    for (const Warped& w : warped_) unseen.setTo(0, w.inside(box));
    const cv::Mat here = region(box);
    cv::dilate(here, near, disc(kBand));
    if (cv::countNonZero(unseen & near) < kBand) return;
    fate.setTo(cv::GC_PR_BGD, unseen | near);
    fate.setTo(cv::GC_FGD, here);
    if (cv::countNonZero(fate == cv::GC_BGD) < kBand * kBand) return;
    cv::Mat colours, background, foreground, label;
    view_.colour(box).convertTo(colours, CV_8U);
    cv::theRNG().state = 1;  // the same from any thread
    cv::grabCut(colours, fate, {}, background, foreground, 3, cv::GC_INIT_WITH_MASK);
    const cv::Mat his = (fate == cv::GC_FGD) | ((fate == cv::GC_PR_FGD) & (unseen | near));
    const int parts = cv::connectedComponents(his, label);
    for (int p = 1; p < parts; ++p)
      if (cv::countNonZero((label == p) & here) > 0) mask(box).setTo(0, label == p);
  }

  // Whether the outline is the view's rather than another one's.
  bool isOddOne(const cv::Mat& region, cv::Rect box) const {
    box = cv::Rect(box.x - kBand, box.y - kBand, box.width + 2 * kBand, box.height + 2 * kBand) &
          cv::Rect(0, 0, width_, height_);
    const cv::Mat here = region(box), seen(here.size(), CV_8U, cv::Scalar(255));
    const auto [own, whole] = outline(view_.colour(box), here, seen);
    for (const Warped& w : warped_) {
      if (agreesAround(here, w.differs(box), w.inside(box), known_(box)) < kAgrees) continue;
      const auto [other, length] = outline(w.colour(box), here, w.inside(box));
      const auto [same, again] = outline(view_.colour(box), here, w.inside(box));
      if (length > kSeen * whole && same > kOutline * other + kOutlineNoise) return true;
    }
    return false;
  }

  // Share of what another one sees around a region that it shows alike; 0 where hardly anything is known of the place.
  static double agreesAround(const cv::Mat& region, const cv::Mat& differs, const cv::Mat& inside,
                             const cv::Mat& known) {
    cv::Mat near, far;
    cv::dilate(region, near, disc(2));
    cv::dilate(region, far, disc(kBand));
    const cv::Mat around = far & ~near & inside;
    const double all = std::max(cv::countNonZero(around), 1);
    if (cv::countNonZero(around & known) < kKnown * all) return 0;
    return cv::countNonZero(around & (differs < kPerhaps)) / all;
  }

  // Mean contrast across a region's outline where it is seen, grey levels, and how much of it is, px.
  static std::pair<double, double> outline(const cv::Mat& colour, const cv::Mat& region, const cv::Mat& seen) {
    cv::Mat inner, outer, rim;
    cv::erode(region, inner, disc(1));
    cv::dilate(region, outer, disc(2));
    rim = outer & ~inner & seen;
    const auto meanOf = [&](const cv::Mat& where) {
      cv::Mat some, sum, weight, shown;
      colour.copyTo(shown, where);
      where.convertTo(some, CV_32F, 1.0 / 255);
      cv::blur(shown, sum, {2 * kBand + 1, 2 * kBand + 1}, {-1, -1}, cv::BORDER_CONSTANT);
      cv::blur(some, weight, {2 * kBand + 1, 2 * kBand + 1}, {-1, -1}, cv::BORDER_CONSTANT);
      rim &= weight > 0.02;
      cv::cvtColor(cv::max(weight, 1e-6), weight, cv::COLOR_GRAY2RGB);
      return cv::Mat(sum / weight);
    };
    const cv::Mat off = meanOf(region & seen) - meanOf(~outer & seen);
    double sum = 0, count = 0;
    for (int y = 0; y < rim.rows; ++y)
      for (int x = 0; x < rim.cols; ++x) {
        if (!rim.at<std::uint8_t>(y, x)) continue;
        sum += cv::norm(off.at<cv::Vec3f>(y, x)) / std::sqrt(3.0);
        count += 1;
      }
    return {count > 0 ? sum / count : 0, count};
  }

  Half view_;
  Camera frame_;
  std::span<const glm::dvec3> points_;
  std::vector<Half> others_;
  int width_ = 0, height_ = 0;
  std::vector<Warped> warped_;  // others, through the completed depth
  cv::Mat explained_;           // 255: looks like another one at some depth
  cv::Mat known_;               // 255: its depth was not completed
};

}  // namespace

Image8 moverMask(const MatchView& view, std::span<const MatchView> others, std::span<const glm::dvec3> points) {
  return Judge(view, others, points).run();
}

}  // namespace ibr
