// SPDX-License-Identifier: Apache-2.0
// Owners of differing regions, before a striped wall that continues beside each region.
#include <catch2/catch.hpp>
#include <initializer_list>
#include <opencv2/core.hpp>
#include <vector>

#include "author/movers/region_owner.h"

using namespace ibr;

namespace {

const cv::Size kView(160, 120);
const cv::Rect kBox(60, 40, 30, 40);
const cv::Scalar kRed(250, 20, 60), kGreen(20, 250, 60);  // equally far from every grey

cv::Mat wall() {
  cv::Mat picture(kView, CV_32FC3);
  for (int y = 0; y < kView.height; ++y)
    for (int x = 0; x < kView.width; ++x) picture.at<cv::Vec3f>(y, x) = cv::Vec3f::all(x % 8 < 4 ? 80.0f : 160.0f);
  return picture;
}

cv::Mat wallWith(cv::Rect object, cv::Scalar colour = kRed) {
  cv::Mat picture = wall();
  picture(object) = colour;
  return picture;
}

cv::Mat maskOf(cv::Rect box) {
  cv::Mat mask(kView, CV_8U, cv::Scalar(0));
  mask(box) = 255;
  return mask;
}

// A view and other photographs that differ within `box`; all depth is known, and all see everything.
RegionEvidence evidenceOf(const cv::Mat& view, std::initializer_list<cv::Mat> others, cv::Rect box = kBox) {
  RegionEvidence evidence{view, maskOf({{}, kView}), cv::Mat(kView, CV_8U, cv::Scalar(0)), {}};
  for (const cv::Mat& colour : others) {
    cv::Mat differs(kView, CV_32F, cv::Scalar(0));
    differs(box) = 40;
    evidence.others.push_back({{colour, maskOf({{}, kView})}, differs});
  }
  return evidence;
}

std::vector<OwnedPart> partsOf(const RegionEvidence& evidence, cv::Rect box = kBox) {
  return partsByOwner(maskOf(box), box, maskOf(box), evidence, {});
}

// The part's mask at the size of the view.
cv::Mat placed(const OwnedPart& part) {
  cv::Mat mask(kView, CV_8U, cv::Scalar(0));
  part.mask.copyTo(mask(cv::Rect(part.corner, part.mask.size())));
  return mask;
}

// True if the part covers the box, except at most its corners, and nothing outside.
bool covers(const OwnedPart& part, cv::Rect box) {
  const cv::Mat mask = placed(part), expected = maskOf(box);
  return cv::countNonZero(mask & ~expected) == 0 && cv::countNonZero(mask) >= box.area() - 4;
}

}  // namespace

TEST_CASE("a region belongs to the photograph whose patches do not continue around it") {
  const std::vector<OwnedPart> own = partsOf(evidenceOf(wallWith(kBox), {wall()}));
  REQUIRE(own.size() == 1);
  CHECK(own[0].owner == RegionOwner::own);
  CHECK(covers(own[0], kBox));
  const std::vector<OwnedPart> another = partsOf(evidenceOf(wall(), {wallWith(kBox)}));
  REQUIRE(another.size() == 1);
  CHECK(another[0].owner == RegionOwner::another);
  CHECK(another[0].other == 0);
  CHECK(covers(another[0], kBox));
}

TEST_CASE("a region is unsure if it matches its surroundings in no photograph, or in all") {
  const std::vector<OwnedPart> none = partsOf(evidenceOf(wallWith(kBox, kRed), {wallWith(kBox, kGreen)}));
  const std::vector<OwnedPart> all = partsOf(evidenceOf(wall(), {wall()}));
  for (const std::vector<OwnedPart>& parts : {none, all}) {
    REQUIRE(parts.size() == 1);
    CHECK(parts[0].owner == RegionOwner::unsure);
    CHECK(cv::norm(placed(parts[0]), maskOf(kBox), cv::NORM_INF) == 0);
  }
}

TEST_CASE("one matching photograph suffices, in any order of the others") {
  const cv::Mat matching = wall(), differing = wallWith(kBox, kGreen);
  for (const RegionEvidence& evidence : {evidenceOf(wallWith(kBox, kRed), {matching, differing}),
                                         evidenceOf(wallWith(kBox, kRed), {differing, matching})}) {
    const std::vector<OwnedPart> parts = partsOf(evidence);
    REQUIRE(parts.size() == 1);
    CHECK(parts[0].owner == RegionOwner::own);
  }
}

TEST_CASE("the other owner is the photograph that agrees most around the region") {
  RegionEvidence evidence = evidenceOf(wall(), {wallWith(kBox), wallWith(kBox)});
  for (const std::size_t noisy : {std::size_t{0}, std::size_t{1}}) {
    cv::Mat& differs = evidence.others[noisy].differs;
    const cv::Mat before = differs.clone();
    differs.rowRange(0, kBox.y - 2) = 50;  // about a quarter of the surroundings
    const std::vector<OwnedPart> parts = partsOf(evidence);
    REQUIRE(parts.size() == 1);
    CHECK(parts[0].owner == RegionOwner::another);
    CHECK(parts[0].other == 1 - noisy);
    differs = before;
  }
}

TEST_CASE("parts of a region may have different owners") {
  const cv::Rect both(50, 40, 60, 40), left(50, 40, 30, 40), right(80, 40, 30, 40);
  const std::vector<OwnedPart> parts = partsOf(evidenceOf(wallWith(left), {wallWith(right)}, both), both);
  REQUIRE(parts.size() == 2);
  CHECK(parts[0].owner == RegionOwner::own);
  CHECK(parts[1].owner == RegionOwner::another);
  const cv::Mat own = placed(parts[0]), another = placed(parts[1]);
  const cv::Rect surelyLeft(51, 41, 23, 38), surelyRight(86, 41, 23, 38);
  CHECK(cv::countNonZero(own(surelyLeft)) == surelyLeft.area());
  CHECK(cv::countNonZero(own(surelyRight)) == 0);
  CHECK(cv::countNonZero(another(surelyRight)) == surelyRight.area());
  CHECK(cv::countNonZero(another(surelyLeft)) == 0);
}

TEST_CASE("a region that no other photograph can judge has no parts") {
  RegionEvidence evidence = evidenceOf(wallWith(kBox), {wall()});
  evidence.known.setTo(0);
  CHECK(partsOf(evidence).empty());
  evidence = evidenceOf(wallWith(kBox), {wall()});
  evidence.others[0].warped.inside.setTo(0);
  CHECK(partsOf(evidence).empty());
  evidence = evidenceOf(wallWith(kBox), {wall()});
  evidence.others[0].differs.setTo(40);  // its surroundings differ as well
  CHECK(partsOf(evidence).empty());
}
