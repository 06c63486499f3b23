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

namespace ibr {
namespace {

constexpr double kAccused = 0.3;      // minimum share of an unsure region that others attribute to its own photograph
constexpr double kUnmet = 0.6;        // share of a region that no other view can judge: above it the region is dropped
constexpr double kSameDepth = 0.3;    // of the larger inverse depth: maximum difference of equal depths
constexpr double kSamePlace = 0.012;  // of the width: maximum distance of equal positions
constexpr double kHidden = 0.25;      // maximum share of a masked region that no other photograph shows
constexpr double kWidened = 0.01;     // of the width, around all masks
constexpr double kRim = 0.004;        // of the width, around objects shown by another photograph
constexpr double kBorder = 0.03;      // of the width: objects shown by another photograph end this far from its border
constexpr double kLargestPixel = 8;   // maximum size of a drawn pixel in another view, px

using Region = std::pair<std::size_t, std::size_t>;  // view, region

class Settlement {
 public:
  explicit Settlement(std::span<const JudgedView> views) : views_(views), near_(views.size()) {
    for (std::uint32_t i = 0; i < views.size(); ++i)
      for (const std::uint32_t j : views[i].judges) {
        near_[i].insert(j);
        near_[j].insert(i);
      }
    for (const JudgedView& view : views) {
      own_.emplace_back(view.odd.width, view.odd.height);
      instead_.push_back(own_.back());
      kept_.push_back(own_.back());
    }
  }

  std::vector<BitMask> run() {
    const std::vector<Region> regions = blamed();
    for (const Region& r : regions)
      for (const OddPixel& p : regionOf(r).pixels) own_[r.first].set(p.x, p.y, true);
    keepHidden(regions);
    std::vector<BitMask> masks(views_.size());
    for (std::size_t i = 0; i < views_.size(); ++i) masks[i] = masked(i);
    return masks;
  }

 private:
  const OddRegion& regionOf(const Region& r) const { return views_[r.first].odd.regions[r.second]; }

  // Projects points of a view into another view.
  class Sight {
   public:
    Sight(const JudgedView& from, const JudgedView& to)
        : map_(frameToMember(from.camera, to.camera)), width_(to.odd.width), height_(to.odd.height) {}
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
    const OddRegions& from = views_[r.first].odd;
    const Sight sight(views_[r.first], views_[to]);
    for (const OddPixel& p : regionOf(r).pixels)
      for (int v = std::max(p.y - rim, border); v <= std::min(p.y + rim, from.height - 1 - border); ++v)
        for (int u = std::max(p.x - rim, border); u <= std::min(p.x + rim, from.width - 1 - border); ++u) {
          const glm::dvec2 place(u + 0.5, v + 0.5);
          const auto at = sight(place, p.inverseDepth), next = sight(place + 1.0, p.inverseDepth);
          if (at) cover(mask, *at, next ? std::max(std::abs(next->x - at->x), std::abs(next->y - at->y)) : 1);
        }
  }

  static void cover(BitMask& mask, glm::dvec2 at, double size) {
    const int half = int(std::ceil(std::min(size, kLargestPixel) / 2));
    for (int y = int(at.y) - half; y <= int(at.y) + half; ++y)
      for (int x = int(at.x) - half; x <= int(at.x) + half; ++x)
        if (mask.inside(x, y)) mask.set(x, y, true);
  }

  // Regions attributed to their own photograph, by that photograph or by another one.
  std::vector<Region> blamed() const {
    std::vector<Region> result;
    for (std::size_t i = 0; i < views_.size(); ++i) {
      BitMask accused(own_[i].width(), own_[i].height());
      for (const std::uint32_t j : near_[i])
        for (std::size_t r = 0; r < views_[j].odd.regions.size(); ++r) {
          const OddRegion& region = views_[j].odd.regions[r];
          if (region.blame == Blame::another && views_[j].judges[region.other] == i) draw({j, r}, i, accused);
        }
      for (std::size_t r = 0; r < views_[i].odd.regions.size(); ++r) {
        const OddRegion& region = views_[i].odd.regions[r];
        const auto said = std::ranges::count_if(region.pixels, [&](const OddPixel& p) { return accused.at(p.x, p.y); });
        const bool own = region.blame == Blame::own ||
                         (region.blame == Blame::unsure && double(said) > kAccused * double(region.pixels.size()));
        if (own && unmetShare({i, r}) < kUnmet) result.emplace_back(i, r);
      }
    }
    return result;
  }

  static glm::dvec2 middle(const OddPixel& p) { return {p.x + 0.5, p.y + 0.5}; }

  // Accepts a point of two views only if both depths agree on the position.
  class Meeting {
   public:
    Meeting(const JudgedView& a, const JudgedView& b)
        : there_(a, b), back_(b, a), depth_(b.odd.depth), tolerance_(kSamePlace * a.odd.width) {}
    std::optional<glm::dvec2> operator()(glm::dvec2 from, float inverseDepth) const {
      const auto at = there_(from, inverseDepth);
      if (!at) return {};
      const float depth = depth_.pixel(int(at->x) / kDepthStep, int(at->y) / kDepthStep)[0];
      const double said = there_.inverseDepth(from, inverseDepth), known = double(depth);
      if (std::abs(said - known) > kSameDepth * std::max(said, known)) return {};
      const auto again = back_(*at, depth);
      return again && glm::distance(*again, from) < tolerance_ ? at : std::nullopt;
    }

   private:
    Sight there_, back_;
    const ImageF& depth_;
    double tolerance_;
  };

  // Share of a region's points that no other view finds (Sight, Meeting) with `shows`(view, pixel) true.
  template <typename Finder, typename Shows>
  double shareWithout(const Region& r, const Shows& shows) const {
    std::vector<std::pair<std::uint32_t, Finder>> others;
    for (const std::uint32_t j : near_[r.first]) others.emplace_back(j, Finder(views_[r.first], views_[j]));
    const std::vector<OddPixel>& pixels = regionOf(r).pixels;
    const auto without = std::ranges::count_if(pixels, [&](const OddPixel& p) {
      return std::ranges::none_of(others, [&](const auto& other) {
        const auto at = other.second(middle(p), p.inverseDepth);
        return at && shows(other.first, glm::ivec2(*at));
      });
    });
    return double(without) / double(pixels.size());
  }

  double unmetShare(const Region& r) const {
    return shareWithout<Meeting>(r, [](std::uint32_t, glm::ivec2) { return true; });
  }

  double hiddenShare(const Region& r) const {
    return shareWithout<Sight>(
        r, [&](std::uint32_t j, glm::ivec2 p) { return !own_[j].at(p.x, p.y) && !instead_[j].at(p.x, p.y); });
  }

  void keepHidden(const std::vector<Region>& regions) {
    std::map<Region, double> hidden;
    for (const Region& r : regions) hidden[r] = hiddenShare(r);
    while (!hidden.empty()) {
      const auto most = std::ranges::max_element(hidden, {}, [](const auto& h) { return h.second; });
      if (most->second <= kHidden) return;
      const Region kept = most->first;
      keep(kept);
      hidden.erase(most);
      for (auto& [region, share] : hidden)
        if (region.first == kept.first || near_[kept.first].contains(std::uint32_t(region.first)))
          share = hiddenShare(region);
    }
  }

  void keep(const Region& r) {
    for (const OddPixel& p : regionOf(r).pixels) {
      own_[r.first].set(p.x, p.y, false);
      kept_[r.first].set(p.x, p.y, true);
    }
    const int width = views_[r.first].odd.width;
    for (const std::uint32_t j : near_[r.first])
      draw(r, std::max(1, int(kRim * width)), int(kBorder * width), j, instead_[j]);
  }

  static cv::Mat picture(const BitMask& mask) {
    cv::Mat result(mask.height(), mask.width(), CV_8U);
    for (int y = 0; y < mask.height(); ++y)
      for (int x = 0; x < mask.width(); ++x) result.at<std::uint8_t>(y, x) = mask.at(x, y) ? 255 : 0;
    return result;
  }

  static cv::Mat widened(const cv::Mat& mask, double px) {
    const int r = std::max(1, int(std::lround(px)));
    cv::Mat result;
    cv::dilate(mask, result, cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * r + 1, 2 * r + 1}));
    return result;
  }

  BitMask masked(std::size_t i) const {
    const int width = own_[i].width();
    const cv::Mat kept = widened(picture(kept_[i]), kRim * width);
    const cv::Mat all =
        (widened(picture(own_[i]), kWidened * width) & ~kept) | (picture(instead_[i]) & ~picture(kept_[i]));
    if (cv::countNonZero(all) == 0) return {};
    BitMask mask(width, own_[i].height());
    for (int y = 0; y < mask.height(); ++y)
      for (int x = 0; x < width; ++x) mask.set(x, y, all.at<std::uint8_t>(y, x) != 0);
    return mask;
  }

  std::span<const JudgedView> views_;
  std::vector<std::set<std::uint32_t>> near_;  // views that judge a view or are judged by it
  std::vector<BitMask> own_, instead_, kept_;  // per view: moving objects; areas shown by another view; kept objects
};

}  // namespace

std::vector<BitMask> settleMovers(std::span<const JudgedView> views) {
  return Settlement(views).run();
}

}  // namespace ibr
