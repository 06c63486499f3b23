// SPDX-License-Identifier: Apache-2.0
#include "author/movers/region_owner.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <opencv2/imgproc.hpp>

#include "author/movers/disc.h"
#include "author/movers/grown_region.h"
#include "author/movers/patch_dissimilarity.h"

namespace ibr {
namespace {

// Distances of a region's patches from the nearest patches around the region.
struct PatchComparison {
  cv::Mat own;             // in the view
  cv::Mat other;           // in the other photograph with the least distance
  cv::Mat judged;          // 8 bits, 255: another photograph judges the pixel
  std::uint32_t best = 0;  // index into RegionEvidence::others: agrees most around the region
};

// Share of a region's surroundings that another photograph shows alike; 0 if too little depth there is known.
double agreesAround(const cv::Mat& region, const cv::Mat& differs, const cv::Mat& inside, const cv::Mat& known,
                    const MoverParameters& p) {
  cv::Mat near, far;
  cv::dilate(region, near, disc(2));
  cv::dilate(region, far, disc(p.outlinePx));
  const cv::Mat around = far & ~near & inside;
  const double all = std::max(cv::countNonZero(around), 1);
  if (cv::countNonZero(around & known) < p.minKnownShare * all) return 0;
  return cv::countNonZero(around & (differs < p.minDifference)) / all;
}

// Mean of `values` over the pixels of `where` in a window of side `windowPx`.
cv::Mat meanAround(const cv::Mat& values, const cv::Mat& where, int windowPx) {
  cv::Mat weight, sum;
  where.convertTo(weight, CV_32F, 1.0 / 255);
  cv::blur(weight, weight, {windowPx, windowPx}, {-1, -1}, cv::BORDER_CONSTANT);
  cv::blur(values, sum, {windowPx, windowPx}, {-1, -1}, cv::BORDER_CONSTANT);
  return sum / cv::max(weight, 1e-6);
}

// `region`, `off`: within the box `at`; pixels in `off` are no exemplars.
PatchComparison compared(const cv::Mat& region, const cv::Mat& off, cv::Rect at, const RegionEvidence& evidence,
                         const MoverParameters& p) {
  PatchComparison result{cv::Mat(region.size(), CV_32F, cv::Scalar(0)), cv::Mat(region.size(), CV_32F, cv::Scalar(1e9)),
                         cv::Mat(region.size(), CV_8U, cv::Scalar(0))};
  const cv::Mat known = evidence.known(at);
  double most = 0;
  for (std::size_t j = 0; j < evidence.others.size(); ++j) {
    const ComparedPhotograph& photograph = evidence.others[j];
    const cv::Mat inside = photograph.warped.inside(at), differs = photograph.differs(at);
    const double agrees = agreesAround(region, differs, inside, known, p);
    const cv::Mat around = ~off & inside & (differs < p.minDifference) & known;
    if (agrees < p.minAgreement || cv::countNonZero(around) < p.minMarginMatches) continue;
    const std::array<cv::Mat, 2> both{evidence.colour(at), photograph.warped.colour(at)};
    const cv::Mat seen = region & inside;
    const cv::Mat own = meanAround(patchDissimilarity(both[0], seen, both, around), seen, p.outlinePx);
    const cv::Mat other = meanAround(patchDissimilarity(both[1], seen, both, around), seen, p.outlinePx);
    const cv::Mat less = seen & (other < result.other);
    own.copyTo(result.own, less);
    other.copyTo(result.other, less);
    result.judged |= seen;
    if (agrees > most) most = agrees, result.best = std::uint32_t(j);
  }
  return result;
}

// Connected parts of `perhaps` of which a sufficient share is in `surely`. `view`: size of the view, px.
std::vector<cv::Mat> decidedParts(const cv::Mat& perhaps, const cv::Mat& surely, const cv::Mat& judged, cv::Size view,
                                  const MoverParameters& p) {
  std::vector<cv::Mat> result;
  cv::Mat label, opened;
  cv::morphologyEx(perhaps, opened, cv::MORPH_OPEN, disc(p.maxThinWidth * view.width));
  const int count = cv::connectedComponents(opened, label);
  for (int n = 1; n < count; ++n) {
    const cv::Mat part = label == n;
    const double area = cv::countNonZero(part);
    if (area >= p.minArea * view.width * view.height && cv::countNonZero(part & surely) >= p.minDecidedShare * area &&
        cv::countNonZero(part & judged) >= p.minSeenShare * area)
      result.push_back(part);
  }
  return result;
}

}  // namespace

std::vector<OwnedPart> partsByOwner(const cv::Mat& region, cv::Rect box, const cv::Mat& differing,
                                    const RegionEvidence& evidence, const MoverParameters& p) {
  const cv::Size view = region.size();
  const int margin = std::max(p.minMarginPx, std::max(box.width, box.height) / 2);
  const cv::Rect at =
      cv::Rect(box.x - margin, box.y - margin, box.width + 2 * margin, box.height + 2 * margin) & cv::Rect({}, view);
  const cv::Mat here = region(at);
  cv::Mat off;
  cv::dilate(differing(at), off, disc(2));
  const PatchComparison c = compared(here, off, at, evidence, p);
  if (cv::countNonZero(c.judged) == 0) return {};
  const cv::Mat mine = c.judged & (c.own > p.minPatchRatio * c.other + p.patchNoise);
  const cv::Mat theirs = c.judged & (c.other > p.minPatchRatio * c.own + p.patchNoise);
  std::vector<OwnedPart> result;
  for (const cv::Mat& part : decidedParts(here & ~theirs, mine, c.judged, view, p)) {
    cv::Mat whole(view, CV_8U, cv::Scalar(0));
    part.copyTo(whole(at));
    result.push_back({RegionOwner::own, 0, grownRegion(whole, evidence.colour, evidence.unseen, p.outlinePx), {}});
  }
  for (const cv::Mat& part : decidedParts(here & ~mine, theirs, c.judged, view, p))
    result.push_back({RegionOwner::another, c.best, part, at.tl()});
  if (result.empty()) result.push_back({RegionOwner::unsure, 0, here, at.tl()});
  return result;
}

}  // namespace ibr
