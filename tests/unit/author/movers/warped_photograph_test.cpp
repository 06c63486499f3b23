// SPDX-License-Identifier: Apache-2.0
// Photographs at half their size, and warped to another camera.
#include <catch2/catch.hpp>
#include <cstdint>
#include <opencv2/core.hpp>

#include "author/movers/warped_photograph.h"

using namespace ibr;

namespace {

constexpr int kWidth = 40, kHeight = 30;
constexpr float kDepth = 0.25f;  // inverse depth, 1 / world unit
constexpr int kParallax = 8;     // px, of two cameras one world unit apart, at kDepth

// A camera at (x, 0, 0) that looks along the negative z axis.
Camera cameraAt(double x) {
  Camera camera;
  camera.intrinsics = {CameraModel::pinhole, kWidth, kHeight, 32, 32, kWidth / 2.0, kHeight / 2.0};
  camera.pose.position = {x, 0, 0};
  return camera;
}

// The photograph of the right camera: a pixel's colour is its position.
HalfSizeView rightView() {
  HalfSizeView view{cameraAt(1), cv::Mat(kHeight, kWidth, CV_32FC3), cv::Mat(kHeight, kWidth, CV_8U, cv::Scalar(255))};
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) view.colour.at<cv::Vec3f>(y, x) = {float(x), float(y), 5};
  return view;
}

bool isColour(const cv::Mat& picture, int x, int y, cv::Vec3f expected) {
  return cv::norm(picture.at<cv::Vec3f>(y, x) - expected) < 1e-2;
}

}  // namespace

TEST_CASE("a warped photograph is shifted by the parallax of each pixel's depth") {
  HalfSizeView right = rightView();
  right.used.at<std::uint8_t>(10, 12) = 0;
  ImageF depth(kWidth, kHeight, 1, kDepth);
  depth.pixel(30, 15)[0] = 0;  // infinity: no parallax
  const WarpedPhotograph w = warpedThrough(depth, cameraAt(0), right);
  REQUIRE(w.colour.size() == cv::Size(kWidth, kHeight));
  REQUIRE(w.inside.size() == cv::Size(kWidth, kHeight));
  int wrongInside = 0, wrongColours = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const int from = x == 30 && y == 15 ? x : x - kParallax;
      const bool inside = from >= 1 && y >= 1 && y < kHeight - 1 && from < kWidth - 1 && !(from == 12 && y == 10);
      wrongInside += (w.inside.at<std::uint8_t>(y, x) == 255) != inside;
      if (inside) wrongColours += !isColour(w.colour, x, y, {float(from), float(y), 5});
    }
  CHECK(wrongInside == 0);
  CHECK(wrongColours == 0);
  CHECK(isColour(w.colour, 2, 15, {0, 15, 5}));  // outside the photograph its border is repeated
}

TEST_CASE("a box warped at a constant depth equals that part of the warped image") {
  const HalfSizeView right = rightView();
  const cv::Rect box(12, 4, 9, 7);
  const WarpedPhotograph whole = warpedThrough(ImageF(kWidth, kHeight, 1, kDepth), cameraAt(0), right);
  const WarpedPhotograph part = warpedAtDepth(kDepth, cameraAt(0), box, right);
  REQUIRE(part.colour.size() == box.size());
  CHECK(cv::norm(part.colour, whole.colour(box), cv::NORM_INF) < 1e-2);
  CHECK(cv::norm(part.inside, whole.inside(box), cv::NORM_INF) == 0);
  CHECK(isColour(part.colour, 0, 0, {12 - kParallax, 4, 5}));
}

TEST_CASE("a point behind the other camera is not inside its image") {
  HalfSizeView ahead = rightView();
  ahead.camera.pose.position = {0, 0, -10};  // ten units along the frame's axis, past the depth of four units
  const WarpedPhotograph w = warpedThrough(ImageF(kWidth, kHeight, 1, kDepth), cameraAt(0), ahead);
  CHECK(cv::countNonZero(w.inside) == 0);
}

TEST_CASE("a view at half its size has mean colours, half the focal length and a widened mask") {
  MatchView view{cameraAt(3), Image8(8, 6, 3), Image8(8, 6, 1, 255)};
  view.camera.intrinsics = {CameraModel::pinhole, 8, 6, 32, 32, 4, 3};
  for (int y = 0; y < 6; ++y)
    for (int x = 0; x < 8; ++x) view.picture.pixel(x, y)[1] = std::uint8_t(10 * (x / 2) + 50 * (y / 2));
  view.mask.pixel(4, 2)[0] = 0;  // a quarter of pixel (2, 1) of the half size
  const HalfSizeView half = halfSizeView(view, 1);
  CHECK(half.camera.intrinsics.width == 4);
  CHECK(half.camera.intrinsics.height == 3);
  CHECK(half.camera.intrinsics.fx == 16);
  CHECK(half.camera.pose.position.x == 3);
  REQUIRE(half.colour.size() == cv::Size(4, 3));
  CHECK(isColour(half.colour, 3, 2, {0, 130, 0}));
  CHECK(isColour(half.colour, 1, 0, {0, 10, 0}));
  REQUIRE(half.used.size() == cv::Size(4, 3));
  CHECK(cv::countNonZero(half.used) == 3);  // the first column: all others are within 1 px of the mask
  CHECK(cv::countNonZero(half.used.col(0)) == 3);
  view.mask = {};
  CHECK(cv::countNonZero(halfSizeView(view, 1).used) == 12);
}
