// SPDX-License-Identifier: Apache-2.0
#include "author/movers/settle_movers.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <map>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <set>
#include <utility>

#include "author/geometry/mean_frame.h"
#include "author/movers/disc.h"

namespace ibr {
namespace {

constexpr double kMinAttributedShare =
    0.3;  // minimum share of an unsure region that others attribute to its own photograph
constexpr double kMaxUncheckedShare =
    0.6;  // share of a region that no other view can judge: above it the region is dropped
constexpr double kMaxDepthDifference = 0.3;       // of the larger inverse depth: maximum difference of equal depths
constexpr double kMaxPositionDifference = 0.012;  // of the width: maximum distance of equal positions
constexpr double kMaxHiddenShare = 0.25;          // maximum share of a masked region that no other photograph shows
constexpr double kMaskMargin = 0.01;              // of the width, around all masks
constexpr double kShownObjectMargin = 0.004;      // of the width, around objects shown by another photograph
constexpr double kBorderMargin =
    0.03;                              // of the width: objects shown by another photograph end this far from its border
constexpr double kMaxPixelSizePx = 8;  // maximum size of a drawn pixel in another view, px

using Region = std::pair<std::size_t, std::size_t>;  // view, region

class MaskResolver {
 public:
  explicit MaskResolver(std::span<const ComparedView> views) : views_(views), near_(views.size()) {
    for (std::uint32_t i = 0; i < views.size(); ++i)
      for (const std::uint32_t j : views[i].comparisons) {
        near_[i].insert(j);
        near_[j].insert(i);
      }
    for (const ComparedView& view : views) {
      own_.emplace_back(view.found.width, view.found.height);
      shownByOthers_.push_back(own_.back());
      kept_.push_back(own_.back());
    }
  }

  std::vector<BitMask> run() {
    const std::vector<Region> regions = ownRegions();
    for (const Region& r : regions)
      for (const DifferingPixel& p : regionOf(r).pixels) own_[r.first].set(p.x, p.y, true);
    keepOccludingRegions(regions);
    std::vector<BitMask> masks(views_.size());
    for (std::size_t i = 0; i < views_.size(); ++i) masks[i] = masked(i);
    return masks;
  }

 private:
  const DifferingRegion& regionOf(const Region& r) const { return views_[r.first].found.regions[r.second]; }

  // Projects points of a view into another view.
  class ViewProjection {
   public:
    ViewProjection(const ComparedView& from, const ComparedView& to)
        : map_(frameToMember(from.camera, to.camera)), width_(to.found.width), height_(to.found.height) {}
    std::optional<glm::dvec2> operator()(glm::dvec2 from, float inverseDepth) const {
      const auto at = map_(from, double(inverseDepth));
      return at && at->x >= 0 && at->y >= 0 && at->x < width_ && at->y < height_ ? at : std::nullopt;
    }

    // Returns the point's inverse depth in the other view.
    double inverseDepth(glm::dvec2 from, float inverseDepth) const {
      return double(inverseDepth) / map_.homogeneous(from, double(inverseDepth)).z;
    }

   private:
    FrameToMember map_;
    int width_, height_;
  };

  // Draws a region as another view sees it, with the area that each pixel covers.
  void draw(const Region& r, std::size_t to, BitMask& mask) const { draw(r, 0, 0, to, mask); }

  // Adds `rim` px around the region, but leaves out the outermost `border` px of its view's image.
  void draw(const Region& r, int rim, int border, std::size_t to, BitMask& mask) const {
    const DifferingRegions& from = views_[r.first].found;
    const ViewProjection projection(views_[r.first], views_[to]);
    for (const DifferingPixel& p : regionOf(r).pixels)
      for (int v = std::max(p.y - rim, border); v <= std::min(p.y + rim, from.height - 1 - border); ++v)
        for (int u = std::max(p.x - rim, border); u <= std::min(p.x + rim, from.width - 1 - border); ++u) {
          const glm::dvec2 place(u + 0.5, v + 0.5);
          const auto at = projection(place, p.inverseDepth), next = projection(place + 1.0, p.inverseDepth);
          if (at) cover(mask, *at, next ? std::max(std::abs(next->x - at->x), std::abs(next->y - at->y)) : 1);
        }
  }

  static void cover(BitMask& mask, glm::dvec2 at, double size) {
    const int half = int(std::ceil(std::min(size, kMaxPixelSizePx) / 2));
    for (int y = int(at.y) - half; y <= int(at.y) + half; ++y)
      for (int x = int(at.x) - half; x <= int(at.x) + half; ++x)
        if (mask.inside(x, y)) mask.set(x, y, true);
  }

  // Regions attributed to their own photograph, by that photograph or by another one.
  std::vector<Region> ownRegions() const {
    std::vector<Region> result;
    for (std::size_t i = 0; i < views_.size(); ++i) {
      BitMask attributed(own_[i].width(), own_[i].height());
      for (const std::uint32_t j : near_[i])
        for (std::size_t r = 0; r < views_[j].found.regions.size(); ++r) {
          const DifferingRegion& region = views_[j].found.regions[r];
          if (region.owner == RegionOwner::another && views_[j].comparisons[region.other] == i)
            draw({j, r}, i, attributed);
        }
      for (std::size_t r = 0; r < views_[i].found.regions.size(); ++r) {
        const DifferingRegion& region = views_[i].found.regions[r];
        const auto attributedPixels =
            std::ranges::count_if(region.pixels, [&](const DifferingPixel& p) { return attributed.at(p.x, p.y); });
        const bool own = region.owner == RegionOwner::own ||
                         (region.owner == RegionOwner::unsure &&
                          double(attributedPixels) > kMinAttributedShare * double(region.pixels.size()));
        if (own && uncheckedShare({i, r}) < kMaxUncheckedShare) result.emplace_back(i, r);
      }
    }
    return result;
  }

  static glm::dvec2 middle(const DifferingPixel& p) { return {p.x + 0.5, p.y + 0.5}; }

  // Accepts a point of two views only if both depths agree on the position.
  class ConsistentProjection {
   public:
    ConsistentProjection(const ComparedView& a, const ComparedView& b)
        : there_(a, b), back_(b, a), depth_(b.found.depth), tolerance_(kMaxPositionDifference * a.found.width) {}
    std::optional<glm::dvec2> operator()(glm::dvec2 from, float inverseDepth) const {
      const auto at = there_(from, inverseDepth);
      if (!at) return {};
      const float depth = depth_.pixel(int(at->x) / kDepthStep, int(at->y) / kDepthStep)[0];
      const double projected = there_.inverseDepth(from, inverseDepth), known = double(depth);
      if (std::abs(projected - known) > kMaxDepthDifference * std::max(projected, known)) return {};
      const auto again = back_(*at, depth);
      return again && glm::distance(*again, from) < tolerance_ ? at : std::nullopt;
    }

   private:
    ViewProjection there_, back_;
    const ImageF& depth_;
    double tolerance_;
  };

  // Share of a region's points that no other view finds (ViewProjection, ConsistentProjection) with `shows`(view,
  // pixel) true.
  template <typename Finder, typename Shows>
  double shareWithout(const Region& r, const Shows& shows) const {
    std::vector<std::pair<std::uint32_t, Finder>> others;
    for (const std::uint32_t j : near_[r.first]) others.emplace_back(j, Finder(views_[r.first], views_[j]));
    const std::vector<DifferingPixel>& pixels = regionOf(r).pixels;
    const auto without = std::ranges::count_if(pixels, [&](const DifferingPixel& p) {
      return std::ranges::none_of(others, [&](const auto& other) {
        const auto at = other.second(middle(p), p.inverseDepth);
        return at && shows(other.first, glm::ivec2(*at));
      });
    });
    return double(without) / double(pixels.size());
  }

  double uncheckedShare(const Region& r) const {
    return shareWithout<ConsistentProjection>(r, [](std::uint32_t, glm::ivec2) { return true; });
  }

  double hiddenShare(const Region& r) const {
    return shareWithout<ViewProjection>(
        r, [&](std::uint32_t j, glm::ivec2 p) { return !own_[j].at(p.x, p.y) && !shownByOthers_[j].at(p.x, p.y); });
  }

  void keepOccludingRegions(const std::vector<Region>& regions) {
    std::map<Region, double> hidden;
    for (const Region& r : regions) hidden[r] = hiddenShare(r);
    while (!hidden.empty()) {
      const auto most = std::ranges::max_element(hidden, {}, [](const auto& h) { return h.second; });
      if (most->second <= kMaxHiddenShare) return;
      const Region kept = most->first;
      keep(kept);
      hidden.erase(most);
      for (auto& [region, share] : hidden)
        if (region.first == kept.first || near_[kept.first].contains(std::uint32_t(region.first)))
          share = hiddenShare(region);
    }
  }

  void keep(const Region& r) {
    for (const DifferingPixel& p : regionOf(r).pixels) {
      own_[r.first].set(p.x, p.y, false);
      kept_[r.first].set(p.x, p.y, true);
    }
    const int width = views_[r.first].found.width;
    for (const std::uint32_t j : near_[r.first])
      draw(r, std::max(1, int(kShownObjectMargin * width)), int(kBorderMargin * width), j, shownByOthers_[j]);
  }

  static cv::Mat picture(const BitMask& mask) {
    cv::Mat result(mask.height(), mask.width(), CV_8U);
    for (int y = 0; y < mask.height(); ++y)
      for (int x = 0; x < mask.width(); ++x) result.at<std::uint8_t>(y, x) = mask.at(x, y) ? 255 : 0;
    return result;
  }

  static cv::Mat widened(const cv::Mat& mask, double px) {
    cv::Mat result;
    cv::dilate(mask, result, disc(px));
    return result;
  }

  BitMask masked(std::size_t i) const {
    const int width = own_[i].width();
    const cv::Mat kept = widened(picture(kept_[i]), kShownObjectMargin * width);
    const cv::Mat all =
        (widened(picture(own_[i]), kMaskMargin * width) & ~kept) | (picture(shownByOthers_[i]) & ~picture(kept_[i]));
    if (cv::countNonZero(all) == 0) return {};
    BitMask mask(width, own_[i].height());
    for (int y = 0; y < mask.height(); ++y)
      for (int x = 0; x < width; ++x) mask.set(x, y, all.at<std::uint8_t>(y, x) != 0);
    return mask;
  }

  std::span<const ComparedView> views_;
  std::vector<std::set<std::uint32_t>> near_;  // views that judge a view or are judged by it
  std::vector<BitMask> own_, shownByOthers_,
      kept_;  // per view: moving objects; areas shown by another view; kept objects
};

}  // namespace

std::vector<BitMask> resolveMoverMasks(std::span<const ComparedView> views) {
  return MaskResolver(views).run();
}

}  // namespace ibr
