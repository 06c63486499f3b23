// SPDX-License-Identifier: Apache-2.0
// Sampling of photographs and weights of the gather, against values computed by hand.
#include "reference/composer_gather.h"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <deque>
#include <glm/gtc/quaternion.hpp>
#include <numbers>

using namespace ibr;
using ibr::reference::Candidate;
using ibr::reference::Gather;
using ibr::reference::Gathered;
using ibr::reference::PhotographSampler;

namespace {

constexpr int kSide = 100;  // px; also the focal length
constexpr double kStep = 0.01;
const glm::dvec2 kMiddle(0.5 * kSide);

Camera pinholeAt(glm::dvec3 position, double focal = kSide) {
  return {{CameraModel::pinhole, kSide, kSide, focal, focal, 0.5 * kSide, 0.5 * kSide}, {position}};
}
Camera panoramaAt(glm::dvec3 position) {
  return {{CameraModel::equirectangular, 2 * kSide, kSide}, {position}};
}

// Candidates of one colour each; each depth map has one ρ.
class Photographs {
 public:
  Candidate& add(const Camera& camera, std::uint8_t level, float ownInverseDepth = 0.25f) {
    const Intrinsics& k = camera.intrinsics;
    Image8 image(k.width, k.height, 4, 255);
    for (std::size_t i = 0; i < image.values.size(); ++i)
      if (i % 4 != 3) image.values[i] = level;
    levels_.push_back({std::move(image)});
    depths_.emplace_back(25, 25, 1, ownInverseDepth);
    Candidate& candidate = candidates.emplace_back();
    candidate.camera = camera;
    candidate.step = kStep;
    candidate.levels = &levels_.back();
    candidate.depth = &depths_.back();
    return candidate;
  }
  std::vector<Image8>& levels(std::size_t i) { return levels_[i]; }
  ImageF& depth(std::size_t i) { return depths_[i]; }

  Gathered gathered(std::size_t colours = 4, double rho = 0.25, glm::dvec2 pixel = kMiddle) const {
    return Gather(pinholeAt({0, 0, 0}), candidates, colours, 1).at(pixel, rho);
  }

  std::vector<Candidate> candidates;

 private:
  std::deque<std::vector<Image8>> levels_;
  std::deque<ImageF> depths_;
};

// Weight of an unoccluded photograph, `x` beside the view's centre, for a point 4 units ahead.
double weightBeside(double x) {
  const double distance = std::hypot(x, 4.0), resolution = 4 / distance;
  return resolution * resolution / (0.03 + std::atan2(x, 4.0));
}

// Returns the weight share of the second of two photographs, whose levels are 0 and 255.
double shareOfSecond(const Photographs& photographs) {
  return photographs.gathered().colour.x;
}

}  // namespace

TEST_CASE("a photograph sampler gives pixel, depth, border and resolution") {
  Photographs photographs;
  photographs.add(pinholeAt({1, 0, 0}, 200), 10);
  photographs.add(panoramaAt({0, 0, -2}), 10);
  const PhotographSampler pinhole(pinholeAt({0, 0, 0}), photographs.candidates[0]),
      panorama(pinholeAt({0, 0, 0}), photographs.candidates[1]);
  const glm::dvec3 ray = pinhole.ray({70, 50}), direction = ray + 0.5 * pinhole.shift();  // of point (.4, 0, −2)
  CHECK(glm::distance(direction, glm::dvec3(-0.3, 0, -1)) < 1e-12);
  CHECK(pinhole.inverseDepth(direction, 0.5) == Approx(0.5));
  REQUIRE_FALSE(pinhole.pixel(direction));  // 60 px left of the picture's centre
  const auto inside = pinhole.pixel({-0.24, 0, -1});
  REQUIRE(inside);
  CHECK(inside->x == Approx(2));
  CHECK(pinhole.border(*inside) == Approx(0.5));
  CHECK(pinhole.border({50, 99}) == Approx(0.25));
  CHECK(pinhole.border(kMiddle) == 1);
  CHECK_FALSE(pinhole.pixel({0, 0, 1}));
  CHECK(pinhole.resolution(ray, 2.0 * ray) == Approx(1));

  const glm::dvec3 up(0, 1.5, -2);  // 1.5 units above the panorama
  const glm::dvec3 own = 0.5 * (up - glm::dvec3(0, 0, -2));
  CHECK(panorama.inverseDepth(own, 0.5) == Approx(1 / 1.5));
  CHECK(panorama.border({0, 50}) == 1);
  CHECK(panorama.resolution({0, 0, -1}, {0, 0, -1}) == Approx(2 * kSide / (2 * std::numbers::pi) / kSide));
  REQUIRE(panorama.pixel({0, 0, 1}));
  CHECK_FALSE(panorama.pixel({0, 0, 0}));
}

TEST_CASE("depth maps are bilinear, clamped at a pinhole's border and wrapped in a panorama") {
  Photographs photographs;
  photographs.add(pinholeAt({0, 0, 0}), 10);
  photographs.add(panoramaAt({0, 0, 0}), 10);
  for (std::size_t i = 0; i < 2; ++i)
    for (int y = 0; y < 25; ++y)
      for (int x = 0; x < 25; ++x) photographs.depth(i).pixel(x, y)[0] = float(x + 100 * y);
  photographs.candidates[0].depthScale = photographs.candidates[1].depthScale = 2;
  const PhotographSampler pinhole(pinholeAt({0, 0, 0}), photographs.candidates[0]),
      panorama(pinholeAt({0, 0, 0}), photographs.candidates[1]);
  CHECK(pinhole.ownInverseDepth({4 * 3.5, 4 * 7.5}) == Approx(2 * 703));
  CHECK(pinhole.ownInverseDepth({4 * 4.0, 4 * 8.0}) == Approx(2 * 753.5));
  CHECK(pinhole.ownInverseDepth({0, 2}) == Approx(0).margin(1e-9));
  CHECK(panorama.ownInverseDepth({0, 2}) == Approx(2 * 12));
  CHECK(panorama.ownInverseDepth({200, 2}) == Approx(2 * 12));
}

TEST_CASE("weights fall with the angle and with the distance of the ray's origin") {
  Photographs photographs;
  photographs.add(pinholeAt({0.5, 0, 0}), 0);
  photographs.add(pinholeAt({-1, 0, 0}), 255);
  const double near = weightBeside(0.5), far = weightBeside(1);
  CHECK(shareOfSecond(photographs) == Approx(far / (near + far)));
  photographs.candidates[1].weight = 0.3;
  CHECK(shareOfSecond(photographs) == Approx(0.3 * far / (near + 0.3 * far)));
  photographs.candidates[1].weight = 1;
  photographs.candidates[1].distance = 7;  // adds .007 rad
  const double costly = far * (0.03 + std::atan2(1, 4)) / (0.037 + std::atan2(1, 4));
  CHECK(shareOfSecond(photographs) == Approx(costly / (near + costly)));
}

TEST_CASE("finer photographs weigh more, up to 1.5 times the view's resolution") {
  for (const double focal : {50.0, 120.0, 400.0}) {
    Photographs photographs;
    photographs.add(pinholeAt({0.5, 0, 0}), 0);
    Camera other = pinholeAt({-0.5, 0, 0}, focal);
    other.intrinsics.cx -= focal * 0.125;  // the point stays at the picture's centre
    photographs.add(other, 255);
    const double own = 4 / std::hypot(0.5, 4.0);
    const double r = std::min(focal / kSide * own, 1.5);
    CHECK(shareOfSecond(photographs) == Approx(r * r / (r * r + own * own)));
  }
}

TEST_CASE("the mip level follows the displacement by uncertain depth") {
  // Columns alternate between black and white, so all smaller mip levels are grey.
  Photographs photographs;
  photographs.add(pinholeAt({1, 0, 0}), 0);
  std::vector<Image8>& levels = photographs.levels(0);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      for (std::size_t c = 0; c < 3; ++c) levels[0].pixel(x, y)[c] = x % 2 == 0 ? 0 : 255;
  for (int side = kSide / 2; side >= 1; side /= 2) {
    levels.emplace_back(side, side, 4, 127);
    if (side == 1) break;
  }
  const Gather gather(pinholeAt({0, 0, 0}), photographs.candidates, 4, 1);
  const auto contrast = [&](double uncertainty) {
    const auto at = [&](double x) { return gather.at({x, kMiddle.y}, 0.25, uncertainty).colour.x; };
    return std::abs(at(40.5) - at(41.5));
  };
  // The point is 4 units ahead, the photograph 1 unit beside: .245 rad at 100 px a radian are 24.5 px.
  CHECK(contrast(0) == Approx(1).margin(0.01));
  CHECK(contrast(1 / 24.5) == Approx(1).margin(0.05));      // one texel
  CHECK(contrast(1.41 / 24.5) == Approx(0.5).margin(0.1));  // half a mip level coarser
  CHECK(contrast(2 / 24.5) == Approx(0).margin(0.1));       // one mip level coarser
  CHECK(contrast(1) == Approx(0).margin(0.01));
  // At the photograph's own position, uncertain depth does not move the pixel.
  photographs.candidates[0].camera.pose.position = {0, 0, 0};
  const Gather own(pinholeAt({0, 0, 0}), photographs.candidates, 4, 1);
  CHECK(own.at({40.5, kMiddle.y}, 0.25, 0.1).colour.x == Approx(0).margin(1e-3));
  CHECK(own.at({41.5, kMiddle.y}, 0.25, 0.1).colour.x == Approx(1).margin(1e-3));
}

TEST_CASE("a hidden photograph weighs little, and one that sees behind the point a quarter") {
  // Tolerance t' = 2 (2 step + .01 ρ) + residual, at ρ = .25.
  constexpr double kTolerance = 2 * (2 * kStep + 0.0025) + 0.005;
  const auto visibility = [&](double own) {
    Photographs photographs;
    photographs.add(pinholeAt({0.5, 0, 0}), 0);
    photographs.add(pinholeAt({-0.5, 0, 0}), 255, float(own)).residual = 0.005;
    const double share = shareOfSecond(photographs);
    return share / (1 - share);
  };
  CHECK(visibility(0.25) == Approx(1));
  CHECK(visibility(0.25 + 0.99 * kTolerance) == Approx(1));
  CHECK(visibility(0.25 + 1.5 * kTolerance) == Approx(0.5).epsilon(1e-4));
  CHECK(visibility(0.25 + 2.1 * kTolerance) == Approx(0.002));
  CHECK(visibility(0.25 - 0.99 * kTolerance) == Approx(1));
  CHECK(visibility(0.25 - 1.5 * kTolerance) == Approx(0.625).epsilon(1e-4));
  CHECK(visibility(0.25 - 2.1 * kTolerance) == Approx(0.25));
}

TEST_CASE("uncertain depth does not hide points within three standard deviations") {
  // The second photograph has a surface in front of the point; their inverse depths differ by half of the point's.
  const auto share = [](float consensus, double uncertainty) {
    Photographs photographs;
    photographs.add(pinholeAt({0.5, 0, 0}), 0);
    photographs.add(pinholeAt({-0.5, 0, 0}), 255, 0.375f);
    photographs.depth(1) = ImageF(25, 25, 2);
    for (std::size_t i = 0; i < photographs.depth(1).values.size(); i += 2) {
      photographs.depth(1).values[i] = 0.375f;
      photographs.depth(1).values[i + 1] = consensus;
    }
    return Gather(pinholeAt({0, 0, 0}), photographs.candidates, 4, 1).at(kMiddle, 0.25, uncertainty).colour.x;
  };
  CHECK(share(1, 0) < 0.01);
  CHECK(share(0.5f, 0) == Approx(share(1, 0)));
  // 2 (2 · .01 + .0025) + 3 · .1 · .375 = .1575: the surface, .125 in front, is within the tolerance.
  CHECK(share(0, 0) == Approx(0.5).margin(0.01));
  // 2 (2 · .01 + .0025) + 3 · .05 · .25 = .0825: visibility falls linearly between one and two tolerances.
  const double visible = 1 - (0.125 / 0.0825 - 1);
  CHECK(share(1, 0.05) == Approx(visible / (1 + visible)).margin(0.01));
}

TEST_CASE("a photograph fades along its border, except at its own pose") {
  Photographs photographs;
  photographs.add(pinholeAt({0.5, 0, 0}), 0);
  Camera other = pinholeAt({-0.5, 0, 0});
  other.intrinsics.cx -= 12.5 + 49;  // the point is 1 px inside the border
  photographs.add(other, 255);
  const double share = shareOfSecond(photographs);
  CHECK(share / (1 - share) == Approx(0.25));

  photographs.candidates[1].camera.pose.position = {0, 0, 0};
  photographs.candidates[1].camera.intrinsics.cx = 0.5;
  photographs.depth(1).values.assign(625, 5.0f);  // the depth also hides the point
  CHECK(shareOfSecond(photographs) > 1 - 1e-4);
  photographs.candidates[1].distance = 5;  // half of the distance at which border and occlusion count in full
  const double apart = 0.5, floor = 0.002;
  const double border = 0.5 / 4;  // half a pixel of the 4 px wide border
  const double weight = (1 + apart * (border - 1)) * (1 + apart * (floor - 1)) / (0.035 * apart);
  CHECK(shareOfSecond(photographs) == Approx(weight / (weight + weightBeside(0.5))));
}

TEST_CASE("the best colours are averaged, with the next colour's weight subtracted") {
  Photographs photographs;
  CHECK_FALSE(photographs.gathered().known);
  photographs.add(pinholeAt({1, 0, 0}), 51);
  photographs.add(pinholeAt({0, 0.5, 0}), 102);
  photographs.add(pinholeAt({-1.5, 0, 0}), 204);
  const double a = weightBeside(1), b = weightBeside(0.5), c = weightBeside(1.5);
  const auto mean = [](const Gathered& gathered) { return gathered.colour.y * 255; };
  CHECK(mean(photographs.gathered(3)) == Approx((51 * a + 102 * b + 204 * c) / (a + b + c)));
  CHECK(mean(photographs.gathered(2)) == Approx((51 * (a - c) + 102 * (b - c)) / (a + b - 2 * c)));
  CHECK(mean(photographs.gathered(1)) == Approx(102));
  CHECK(photographs.gathered(1).variance == Approx(0).margin(1e-9));
  const double m = mean(photographs.gathered(2)), share = (b - c) / (a + b - 2 * c);
  CHECK(photographs.gathered(2).variance == Approx((1 - share) * (51 - m) * (51 - m) + share * (102 - m) * (102 - m)));
  for (Candidate& candidate : photographs.candidates) candidate.camera.pose.rotation = {0, 0, 1, 0};  // looks away
  CHECK_FALSE(photographs.gathered(2).known);
}

TEST_CASE("a mask reduces a photograph's weight, to zero from half coverage on") {
  for (const auto& [alpha, left] : {std::pair{255, 1.0}, std::pair{204, 0.6}, std::pair{127, 0.0}, std::pair{0, 0.0}}) {
    Photographs photographs;
    photographs.add(pinholeAt({0.5, 0, 0}), 0);
    photographs.add(pinholeAt({-0.5, 0, 0}), 255).masked = true;
    std::vector<Image8>& levels = photographs.levels(1);
    for (std::size_t i = 3; i < levels[0].values.size(); i += 4) levels[0].values[i] = std::uint8_t(alpha);
    CHECK(shareOfSecond(photographs) == Approx(left / (1 + left)));
  }
}
