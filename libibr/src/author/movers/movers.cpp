// SPDX-License-Identifier: Apache-2.0
#include "author/movers/movers.h"

#include <algorithm>
#include <cstddef>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "author/backdrop/complete_depth.h"
#include "author/movers/colour_comparison.h"
#include "author/movers/disc.h"
#include "author/movers/region_owner.h"
#include "author/movers/static_depth.h"
#include "author/movers/warped_photograph.h"
#include "author/pixels/cv_view.h"

namespace ibr {
namespace {

// The view and the other photographs at half size.
struct HalfSizeViews {
  HalfSizeView view;
  std::vector<HalfSizeView> others;
  float maxInverseDepth;  // upper limit of the depths that are tried on a region
};

// Inverse depth of static surfaces: completed where it was not matched.
ImageF completedDepth(const HalfSizeView& view, const ImageF& matched, const cv::Mat& discarded) {
  Image8 colours(matched.width, matched.height, 3);
  cv::Mat to = cvView(colours);
  view.colour.convertTo(to, CV_8U);
  ImageF depth = completeDepth(matched, colours);
  if (!discarded.empty()) depth = harmonicDepth(std::move(depth), discarded);
  return depth;
}

// Compares the other photographs with the view through `depth`. `matched`: the depth that was not completed.
RegionEvidence evidenceThrough(const ImageF& depth, const ImageF& matched, const HalfSizeViews& views,
                               const MoverParameters& p) {
  const HalfSizeView& view = views.view;
  cv::Mat seen(depth.height, depth.width, CV_8U, cv::Scalar(0));
  RegionEvidence evidence{view.colour, cvView(matched) != kUnknownDepth, {}, {}};
  for (const HalfSizeView& other : views.others) {
    WarpedPhotograph w = warpedThrough(depth, view.camera, other);
    const cv::Mat same = greyAgreement(view.colour, w.colour, p.minCorrelation).textured;
    w.colour = exposureMatched(view.colour, w.colour, same & w.inside & view.used);
    const cv::Mat differs = colourDifference(view.colour, w.colour, p.misalignmentPx, p.differenceWindowPx);
    seen |= w.inside;
    evidence.others.push_back({std::move(w), differs});
  }
  evidence.unseen = seen == 0;
  return evidence;
}

// Minimum difference over the photographs that see the pixel, 8-bit levels; 0 if none does.
cv::Mat minDifferenceMap(const RegionEvidence& evidence, const cv::Mat& used) {
  cv::Mat least(used.size(), CV_32F, cv::Scalar(255));
  for (const ComparedPhotograph& other : evidence.others) {
    const cv::Mat smaller = cv::min(least, other.differs);
    smaller.copyTo(least, other.warped.inside);
  }
  least.setTo(0, evidence.unseen | (used == 0));
  return least;
}

// Returns the share of a region that matches another photograph at some depth: a static region of wrong depth.
double staticShare(const cv::Mat& region, cv::Rect box, const HalfSizeViews& views, const MoverParameters& p) {
  cv::Mat alike(box.size(), CV_8U, cv::Scalar(0));
  for (const HalfSizeView& other : views.others)
    for (int level = 0; level < p.depthLevels; ++level) {
      const float depth = views.maxInverseDepth * float(level) / float(p.depthLevels);
      const WarpedPhotograph w = warpedAtDepth(depth, views.view.camera, box, other);
      cv::Mat same = greyAgreement(views.view.colour(box), w.colour, p.minCorrelation).textured & w.inside;
      cv::morphologyEx(same, same, cv::MORPH_OPEN, disc(p.minPatchRadiusPx));
      alike |= same;
    }
  return double(cv::countNonZero(alike & region)) / cv::countNonZero(region);
}

DifferingRegion differingRegion(const OwnedPart& part, const ImageF& depth) {
  DifferingRegion result{part.owner, part.other, {}};
  for (int y = 0; y < part.mask.rows; ++y)
    for (int x = 0; x < part.mask.cols; ++x)
      if (part.mask.at<std::uint8_t>(y, x)) {
        const int u = part.corner.x + x, v = part.corner.y + y;
        result.pixels.push_back({std::uint16_t(u), std::uint16_t(v), depth.pixel(u, v)[0]});
      }
  return result;
}

// Finds the regions that differ, and their owners, with the depth known so far. `discarded`: 8 bits, 255: pixels whose
// depth is completed without colours; or empty. Returns the completed depth of all pixels.
DifferingRegions regionsThrough(const ImageF& matched, const cv::Mat& discarded, const HalfSizeViews& views,
                                const MoverParameters& p) {
  const int width = matched.width, height = matched.height;
  DifferingRegions found{width, height, {}, completedDepth(views.view, matched, discarded)};
  const RegionEvidence evidence = evidenceThrough(found.depth, matched, views, p);
  const cv::Mat differs = minDifferenceMap(evidence, views.view.used);
  cv::Mat perhaps = differs >= p.minDifference;
  cv::morphologyEx(perhaps, perhaps, cv::MORPH_OPEN, disc(p.maxThinWidth * width));
  cv::morphologyEx(perhaps, perhaps, cv::MORPH_CLOSE, disc(2 * p.maxThinWidth * width));
  cv::Mat label, stats, centre;
  const int count = cv::connectedComponentsWithStats(perhaps, label, stats, centre);
  double all = 0;
  for (int r = 1; r < count; ++r) {
    const cv::Rect box(stats.at<int>(r, cv::CC_STAT_LEFT), stats.at<int>(r, cv::CC_STAT_TOP),
                       stats.at<int>(r, cv::CC_STAT_WIDTH), stats.at<int>(r, cv::CC_STAT_HEIGHT));
    const double area = stats.at<int>(r, cv::CC_STAT_AREA);
    if (area < p.minArea * width * height || area > p.maxArea * width * height) continue;
    const cv::Mat region = label == r;
    const double core = cv::countNonZero(region(box) & (differs(box) >= p.minCoreDifference));
    if (core < p.minCoreShare * area || staticShare(region(box), box, views, p) > p.maxStaticShare) continue;
    for (const OwnedPart& part : partsByOwner(region, box, perhaps, evidence, p))
      found.regions.push_back(differingRegion(part, found.depth));
    all += area;
  }
  if (all > p.maxArea * width * height) found.regions.clear();  // almost nothing matches: no photograph can judge
  return found;
}

// 8 bits, 255: pixels of the regions, and `radiusPx` around them.
cv::Mat areaOf(const DifferingRegions& found, double radiusPx) {
  cv::Mat area(found.height, found.width, CV_8U, cv::Scalar(0));
  for (const DifferingRegion& region : found.regions)
    for (const DifferingPixel& p : region.pixels) area.at<std::uint8_t>(p.y, p.x) = 255;
  cv::dilate(area, area, disc(radiusPx));
  return area;
}

// Returns every kDepthStep-th pixel in x and y.
ImageF thinnedDepth(const ImageF& depth) {
  ImageF result((depth.width + kDepthStep - 1) / kDepthStep, (depth.height + kDepthStep - 1) / kDepthStep, 1);
  for (int y = 0; y < result.height; ++y)
    for (int x = 0; x < result.width; ++x) result.pixel(x, y)[0] = depth.pixel(x * kDepthStep, y * kDepthStep)[0];
  return result;
}

}  // namespace

DifferingRegions differingRegions(const MatchView& view, std::span<const MatchView> others, const ImageF& depth,
                                  const MoverParameters& parameters) {
  HalfSizeViews views{halfSizeView(view, parameters.maskMarginPx), {}, *std::ranges::max_element(depth.values)};
  for (const MatchView& other : others) views.others.push_back(halfSizeView(other, parameters.maskMarginPx));
  const Intrinsics& frame = views.view.camera.intrinsics;
  ImageF matched = confirmedDepth(resampledDepth(depth, frame.width, frame.height), views.view, views.others,
                                  parameters.minMatchRadiusPx);
  DifferingRegions found = regionsThrough(matched, {}, views, parameters);
  if (!found.regions.empty()) {
    // Photographs cannot agree on the depth of moving objects, so any match there is chance. Depth completed from such
    // a match would be wrong.
    const cv::Mat discarded = areaOf(found, parameters.minMatchRadiusPx);
    cvView(matched).setTo(kUnknownDepth, discarded);
    found = regionsThrough(matched, discarded, views, parameters);
  }
  found.depth = thinnedDepth(found.depth);
  return found;
}

}  // namespace ibr
