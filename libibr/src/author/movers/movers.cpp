// SPDX-License-Identifier: Apache-2.0
#include "author/movers/movers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "author/backdrop/complete_depth.h"
#include "author/geometry/mean_frame.h"
#include "author/movers/patch_dissimilarity.h"
#include "author/photographs/masks.h"
#include "author/pixels/cv_view.h"
#include "author/sweep/window_agreement.h"
#include "base/check.h"
#include "ibr/author/photographs.h"

namespace ibr {
namespace {

constexpr int kRelaxationSweeps = 200;  // of successive over-relaxation
constexpr float kOverRelaxation = 1.9f;

cv::Mat disc(double radius) {
  const int r = std::max(1, int(std::lround(radius)));
  return cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * r + 1, 2 * r + 1});
}

cv::Mat grey(const cv::Mat& colour) {
  cv::Mat result;
  cv::cvtColor(colour, result, cv::COLOR_RGB2GRAY);
  return result;
}

// A photograph at half the matched size.
struct HalfSizeView {
  Camera camera;
  cv::Mat colour;  // float, 3 channels
  cv::Mat used;    // 255: not masked
};

HalfSizeView halfSizeView(const MatchView& view, int maskMargin) {
  const int width = std::max(view.picture.width / 2, 1), height = std::max(view.picture.height / 2, 1);
  HalfSizeView half{{resized(view.camera.intrinsics, width, height), view.camera.pose}, {}, {}};
  const Image8 small = downscaled(view.picture, width, height);
  cvView(small).convertTo(half.colour, CV_32F);
  const Image8 mask = widenedMask(resizedMask(view.mask, width, height), maskMargin);
  half.used = mask.empty() ? cv::Mat(height, width, CV_8U, cv::Scalar(255)) : cvView(mask).clone();
  return half;
}

// Samples the nearest pixel: interpolation between two surfaces would invent depth.
ImageF sampled(const ImageF& map, int width, int height) {
  ImageF result(width, height, 1);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      result.pixel(x, y)[0] = map.pixel(int((x + 0.5) * map.width / width), int((y + 0.5) * map.height / height))[0];
  return result;
}

// Another photograph, warped to the frame through a depth map.
struct Warped {
  cv::Mat colour, inside;  // 255: inside its image and not masked
  cv::Mat differs;         // from the view, grey levels
};

class MoverDetector {
 public:
  MoverDetector(const MatchView& view, std::span<const MatchView> others, const ImageF& depth,
                const MoverParameters& parameters)
      : p_(parameters),
        view_(halfSizeView(view, p_.maskMarginPx)),
        frame_(view_.camera),
        width_(frame_.intrinsics.width),
        height_(frame_.intrinsics.height),
        nearest_(*std::ranges::max_element(depth.values)),
        matched_(sampled(depth, width_, height_)) {
    for (const MatchView& other : others) others_.push_back(halfSizeView(other, p_.maskMarginPx));
  }

  DifferingRegions run() {
    dropUnconfirmedDepth();
    DifferingRegions found = look();
    if (!found.regions.empty()) {
      discardDepth(found);
      found = look();
    }
    found.depth = ImageF((width_ + kDepthStep - 1) / kDepthStep, (height_ + kDepthStep - 1) / kDepthStep, 1);
    for (int y = 0; y < found.depth.height; ++y)
      for (int x = 0; x < found.depth.width; ++x)
        found.depth.pixel(x, y)[0] = depth_.pixel(x * kDepthStep, y * kDepthStep)[0];
    return found;
  }

 private:
  Warped warped(const HalfSizeView& other, const ImageF& depth) const {
    return warped(other, {0, 0, width_, height_}, [&](int x, int y) { return depth.pixel(x, y)[0]; });
  }

  // `depthAt`: called for pixels of the box.
  template <class DepthAt>
  Warped warped(const HalfSizeView& other, cv::Rect box, const DepthAt& depthAt) const {
    const FrameToMember map = frameToMember(frame_, other.camera);
    const Intrinsics& k = other.camera.intrinsics;
    cv::Mat at(box.size(), CV_32FC2);
    Warped result{{}, cv::Mat(box.size(), CV_8U, cv::Scalar(0))};
    for (int y = 0; y < box.height; ++y)
      for (int x = 0; x < box.width; ++x) {
        const auto pixel = map({box.x + x + 0.5, box.y + y + 0.5}, double(depthAt(box.x + x, box.y + y)));
        const glm::dvec2 p = pixel.value_or(glm::dvec2(-1));
        at.at<cv::Vec2f>(y, x) = {float(p.x - 0.5), float(p.y - 0.5)};
        if (p.x < 1 || p.y < 1 || p.x > k.width - 1 || p.y > k.height - 1) continue;
        result.inside.at<std::uint8_t>(y, x) = other.used.at<std::uint8_t>(int(p.y), int(p.x));
      }
    cv::remap(other.colour, result.colour, at, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
    return result;
  }

  cv::Mat texturedMatch(const cv::Mat& a, const cv::Mat& b) const {
    return agreement(grey(a), grey(b), p_.minCorrelation).textured;
  }

  // Scales each channel of `b` to the brightness of `a` by the median ratio where both look alike.
  static cv::Mat exposureMatched(const cv::Mat& a, const cv::Mat& b, const cv::Mat& where) {
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

  // Distance of `a` from the range of `b` around each pixel, or of `b` from that of `a`: the larger, grey levels.
  cv::Mat difference(const cv::Mat& a, const cv::Mat& b) const {
    const cv::Mat around =
        cv::getStructuringElement(cv::MORPH_RECT, {2 * p_.misalignmentPx + 1, 2 * p_.misalignmentPx + 1});
    const auto outside = [&](const cv::Mat& one, const cv::Mat& other) {
      cv::Mat high, low;
      cv::dilate(other, high, around);
      cv::erode(other, low, around);
      cv::Mat off = cv::max(one - high, 0) + cv::max(low - one, 0);
      std::array<cv::Mat, 3> channel;
      cv::split(off, channel.data());
      cv::Mat square = channel[0].mul(channel[0]) + channel[1].mul(channel[1]) + channel[2].mul(channel[2]), length;
      cv::sqrt(square / 3, length);
      cv::blur(length, length, {p_.differenceWindowPx, p_.differenceWindowPx});
      return length;
    };
    return cv::max(outside(a, b), outside(b, a));
  }

  // Drops depth at which no other photograph looks alike, as on a moving object.
  void dropUnconfirmedDepth() {
    cv::Mat alike(height_, width_, CV_8U, cv::Scalar(0));
    for (const HalfSizeView& other : others_) {
      const Warped w = warped(other, matched_);
      alike |= agreement(grey(view_.colour), grey(w.colour)).alike & w.inside;
    }
    alike &= view_.used & (cvView(matched_) != kUnknownDepth);
    cv::morphologyEx(alike, alike, cv::MORPH_OPEN, disc(p_.minMatchRadiusPx));
    cvView(matched_).setTo(kUnknownDepth, alike == 0);
    known_ = cvView(matched_) != kUnknownDepth;
  }

  // Finds the regions that differ, with the depth known so far.
  DifferingRegions look() {
    Image8 colours(width_, height_, 3);
    cv::Mat to = cvView(colours);
    view_.colour.convertTo(to, CV_8U);
    depth_ = completeDepth(matched_, colours);
    if (!discarded_.empty()) smoothDepth();
    warped_.clear();
    for (const HalfSizeView& other : others_) {
      Warped w = warped(other, depth_);
      w.colour = exposureMatched(view_.colour, w.colour, texturedMatch(view_.colour, w.colour) & w.inside & view_.used);
      w.differs = difference(view_.colour, w.colour);
      warped_.push_back(std::move(w));
    }
    return regions(minDifferenceMap());
  }

  // Drops the depth of moving objects: photographs cannot agree on it, so any match there is chance. Depth completed
  // from such a match would be wrong.
  void discardDepth(const DifferingRegions& found) {
    discarded_ = cv::Mat(height_, width_, CV_8U, cv::Scalar(0));
    for (const DifferingRegion& region : found.regions)
      for (const DifferingPixel& p : region.pixels) discarded_.at<std::uint8_t>(p.y, p.x) = 255;
    cv::dilate(discarded_, discarded_, disc(p_.minMatchRadiusPx));
    cvView(matched_).setTo(kUnknownDepth, discarded_);
    known_.setTo(0, discarded_);
  }

  // Fills depth behind moving objects without using their colours: inverse depth is harmonic, as on any plane.
  void smoothDepth() {
    std::vector<cv::Point> inside;
    cv::findNonZero(discarded_, inside);
    const auto at = [&](int x, int y) {
      return depth_.pixel(std::clamp(x, 0, width_ - 1), std::clamp(y, 0, height_ - 1))[0];
    };
    for (int sweep = 0; sweep < kRelaxationSweeps; ++sweep)
      for (const cv::Point p : inside) {
        float& value = depth_.pixel(p.x, p.y)[0];
        const float mean = (at(p.x - 1, p.y) + at(p.x + 1, p.y) + at(p.x, p.y - 1) + at(p.x, p.y + 1)) / 4;
        value = std::max(value + kOverRelaxation * (mean - value), 0.0f);
      }
  }

  // Returns the share of a region that matches another photograph at some depth: a static region of wrong depth.
  double staticShare(const cv::Mat& region, cv::Rect box) const {
    cv::Mat alike(box.size(), CV_8U, cv::Scalar(0));
    for (const HalfSizeView& other : others_)
      for (int level = 0; level < p_.depthLevels; ++level) {
        const float depth = nearest_ * float(level) / float(p_.depthLevels);
        const Warped w = warped(other, box, [&](int, int) { return depth; });
        cv::Mat same = texturedMatch(view_.colour(box), w.colour) & w.inside;
        cv::morphologyEx(same, same, cv::MORPH_OPEN, disc(p_.minPatchRadiusPx));
        alike |= same;
      }
    return double(cv::countNonZero(alike & region)) / cv::countNonZero(region);
  }

  // Minimum difference over the photographs that see the pixel, grey levels; 0 if none does.
  cv::Mat minDifferenceMap() const {
    cv::Mat least(height_, width_, CV_32F, cv::Scalar(255)), any(height_, width_, CV_8U, cv::Scalar(0));
    for (const Warped& w : warped_) {
      const cv::Mat smaller = cv::min(least, w.differs);
      smaller.copyTo(least, w.inside);
      any |= w.inside;
    }
    least.setTo(0, (any == 0) | (view_.used == 0));
    return least;
  }

  // Splits the differing pixels into regions.
  DifferingRegions regions(const cv::Mat& differs) const {
    cv::Mat perhaps = differs >= p_.minDifference;
    cv::morphologyEx(perhaps, perhaps, cv::MORPH_OPEN, disc(p_.maxThinWidth * width_));
    cv::morphologyEx(perhaps, perhaps, cv::MORPH_CLOSE, disc(2 * p_.maxThinWidth * width_));
    cv::Mat label, stats, centre;
    const int count = cv::connectedComponentsWithStats(perhaps, label, stats, centre);
    DifferingRegions found{width_, height_, {}, {}};
    double all = 0;
    for (int r = 1; r < count; ++r) {
      const cv::Rect box(stats.at<int>(r, cv::CC_STAT_LEFT), stats.at<int>(r, cv::CC_STAT_TOP),
                         stats.at<int>(r, cv::CC_STAT_WIDTH), stats.at<int>(r, cv::CC_STAT_HEIGHT));
      const double area = stats.at<int>(r, cv::CC_STAT_AREA);
      if (area < p_.minArea * width_ * height_ || area > p_.maxArea * width_ * height_) continue;
      const cv::Mat region = label == r;
      const double core = cv::countNonZero(region(box) & (differs(box) >= p_.minCoreDifference));
      if (core < p_.minCoreShare * area || staticShare(region(box), box) > p_.maxStaticShare) continue;
      assignOwner(region, box, perhaps, found);
      all += area;
    }
    if (all > p_.maxArea * width_ * height_) found.regions.clear();  // almost nothing matches: no photograph can judge
    return found;
  }

  // Unmatched-patch distance of a region in the view, and in the other photograph with the least distance; and the
  // pixels that are judged.
  struct Comparison {
    cv::Mat own, other, judged;
    std::uint32_t best = 0;  // index in `others`: agrees most around the region
  };

  cv::Mat meanAround(const cv::Mat& values, const cv::Mat& where) const {
    cv::Mat weight, sum;
    where.convertTo(weight, CV_32F, 1.0 / 255);
    cv::blur(weight, weight, {p_.outlinePx, p_.outlinePx}, {-1, -1}, cv::BORDER_CONSTANT);
    cv::blur(values, sum, {p_.outlinePx, p_.outlinePx}, {-1, -1}, cv::BORDER_CONSTANT);
    return sum / cv::max(weight, 1e-6);
  }

  // `region`, `off`: pixels in `off` are no exemplars; both within the box `at`.
  Comparison compared(const cv::Mat& region, const cv::Mat& off, cv::Rect at) const {
    Comparison result{cv::Mat(region.size(), CV_32F, cv::Scalar(0)), cv::Mat(region.size(), CV_32F, cv::Scalar(1e9)),
                      cv::Mat(region.size(), CV_8U, cv::Scalar(0))};
    double most = 0;
    for (std::size_t j = 0; j < warped_.size(); ++j) {
      const cv::Mat inside = warped_[j].inside(at), differs = warped_[j].differs(at);
      const double agrees = agreesAround(region, differs, inside, known_(at));
      const cv::Mat around = ~off & inside & (differs < p_.minDifference) & known_(at);
      if (agrees < p_.minAgreement || cv::countNonZero(around) < p_.minMarginMatches) continue;
      const std::array<cv::Mat, 2> both{view_.colour(at), warped_[j].colour(at)};
      const cv::Mat seen = region & inside;
      const cv::Mat own = meanAround(patchDissimilarity(both[0], seen, both, around), seen);
      const cv::Mat other = meanAround(patchDissimilarity(both[1], seen, both, around), seen);
      const cv::Mat less = seen & (other < result.other);
      own.copyTo(result.own, less);
      other.copyTo(result.other, less);
      result.judged |= seen;
      if (agrees > most) most = agrees, result.best = std::uint32_t(j);
    }
    return result;
  }

  // Decides to which photograph a region, or each of its parts, belongs.
  void assignOwner(const cv::Mat& region, cv::Rect box, const cv::Mat& differing, DifferingRegions& found) const {
    const int margin = std::max(p_.minMarginPx, std::max(box.width, box.height) / 2);
    const cv::Rect at = cv::Rect(box.x - margin, box.y - margin, box.width + 2 * margin, box.height + 2 * margin) &
                        cv::Rect(0, 0, width_, height_);
    const cv::Mat here = region(at);
    cv::Mat off;
    cv::dilate(differing(at), off, disc(2));
    const Comparison c = compared(here, off, at);
    if (cv::countNonZero(c.judged) == 0) return;
    const cv::Mat mine = c.judged & (c.own > p_.minPatchRatio * c.other + p_.patchNoise);
    const cv::Mat theirs = c.judged & (c.other > p_.minPatchRatio * c.own + p_.patchNoise);
    const std::vector<cv::Mat> own = parts(here & ~theirs, mine, c.judged),
                               others = parts(here & ~mine, theirs, c.judged);
    for (const cv::Mat& part : own) {
      cv::Mat all(height_, width_, CV_8U, cv::Scalar(0)), mask(height_, width_, CV_8U, cv::Scalar(255));
      part.copyTo(all(at));
      mask.setTo(0, all);
      growMask(all, cv::boundingRect(all), mask);
      add(mask == 0, {}, {RegionOwner::own, 0, {}}, found);
    }
    for (const cv::Mat& part : others) add(part, at.tl(), {RegionOwner::another, c.best, {}}, found);
    if (own.empty() && others.empty()) add(here, at.tl(), {}, found);
  }

  // Connected parts of `perhaps` of which a sufficient share is in `surely`.
  std::vector<cv::Mat> parts(const cv::Mat& perhaps, const cv::Mat& surely, const cv::Mat& judged) const {
    std::vector<cv::Mat> result;
    cv::Mat label, opened;
    cv::morphologyEx(perhaps, opened, cv::MORPH_OPEN, disc(p_.maxThinWidth * width_));
    const int count = cv::connectedComponents(opened, label);
    for (int p = 1; p < count; ++p) {
      const cv::Mat part = label == p;
      const double area = cv::countNonZero(part);
      if (area >= p_.minArea * width_ * height_ && cv::countNonZero(part & surely) >= p_.minDecidedShare * area &&
          cv::countNonZero(part & judged) >= p_.minSeenShare * area)
        result.push_back(part);
    }
    return result;
  }

  void add(const cv::Mat& region, cv::Point at, DifferingRegion result, DifferingRegions& found) const {
    for (int y = 0; y < region.rows; ++y)
      for (int x = 0; x < region.cols; ++x)
        if (region.at<std::uint8_t>(y, x))
          result.pixels.push_back(
              {std::uint16_t(at.x + x), std::uint16_t(at.y + y), depth_.pixel(at.x + x, at.y + y)[0]});
    found.regions.push_back(std::move(result));
  }

  // Extends the mask with GrabCut (Rother, Kolmogorov & Blake 2004) into pixels that no other photograph covers: a
  // half-masked person looks worse than an unmasked one.
  void growMask(const cv::Mat& region, cv::Rect box, cv::Mat& mask) const {
    const cv::Rect whole(0, 0, width_, height_);
    box = cv::Rect(box.x - box.width / 2, box.y - box.height, 2 * box.width, 3 * box.height) & whole;
    cv::Mat unseen(box.size(), CV_8U, cv::Scalar(255)), near, fate(box.size(), CV_8U, cv::Scalar(cv::GC_BGD));
    for (const Warped& w : warped_) unseen.setTo(0, w.inside(box));
    const cv::Mat here = region(box);
    cv::dilate(here, near, disc(p_.outlinePx));
    if (cv::countNonZero(unseen & near) < p_.outlinePx) return;
    fate.setTo(cv::GC_PR_BGD, unseen | near);
    fate.setTo(cv::GC_FGD, here);
    if (cv::countNonZero(fate == cv::GC_BGD) < p_.outlinePx * p_.outlinePx) return;
    cv::Mat colours, background, foreground, label;
    view_.colour(box).convertTo(colours, CV_8U);
    cv::theRNG().state = 1;  // the same result on any thread
    cv::grabCut(colours, fate, {}, background, foreground, 3, cv::GC_INIT_WITH_MASK);
    const cv::Mat his = (fate == cv::GC_FGD) | ((fate == cv::GC_PR_FGD) & (unseen | near));
    const int parts = cv::connectedComponents(his, label);
    for (int p = 1; p < parts; ++p)
      if (cv::countNonZero((label == p) & here) > 0) mask(box).setTo(0, label == p);
  }

  // Share of a region's surroundings that another photograph shows alike; 0 if too little depth there is known.
  double agreesAround(const cv::Mat& region, const cv::Mat& differs, const cv::Mat& inside,
                      const cv::Mat& known) const {
    cv::Mat near, far;
    cv::dilate(region, near, disc(2));
    cv::dilate(region, far, disc(p_.outlinePx));
    const cv::Mat around = far & ~near & inside;
    const double all = std::max(cv::countNonZero(around), 1);
    if (cv::countNonZero(around & known) < p_.minKnownShare * all) return 0;
    return cv::countNonZero(around & (differs < p_.minDifference)) / all;
  }

  const MoverParameters& p_;
  HalfSizeView view_;
  Camera frame_;
  std::vector<HalfSizeView> others_;
  int width_, height_;
  float nearest_;               // inverse depth
  ImageF matched_, depth_;      // inverse depth; completed
  std::vector<Warped> warped_;  // others, through the completed depth
  cv::Mat known_;               // 255: depth was not completed
  cv::Mat discarded_;           // 255: depth must stay unknown
};

}  // namespace

DifferingRegions differingRegions(const MatchView& view, std::span<const MatchView> others, const ImageF& depth,
                                  const MoverParameters& parameters) {
  return MoverDetector(view, others, depth, parameters).run();
}

}  // namespace ibr
