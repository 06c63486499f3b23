// SPDX-License-Identifier: Apache-2.0
#include "author/geometry/lens_distortion.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <vector>

#include "ibr/author/poses.h"
#include "ibr/error.h"
#include "support/temporary_folder.h"

using namespace ibr;

namespace {

constexpr int kWidth = 640, kHeight = 480;

struct Kind {
  const char* name;
  LensModel model;
  std::vector<double> mild, strong;  // strong: wide-angle values, which fold back for most models
};

// Parameters of the magnitude that calibrations yield.
const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all{
      {"SIMPLE_PINHOLE", LensModel::simplePinhole, {500, 322, 239}, {150, 300, 250}},
      {"PINHOLE", LensModel::pinhole, {500, 510, 322, 239}, {150, 160, 322, 239}},
      {"SIMPLE_RADIAL", LensModel::simpleRadial, {500, 322, 239, -0.1}, {300, 322, 239, -0.3}},
      {"RADIAL", LensModel::radial, {500, 322, 239, -0.1, 0.03}, {300, 322, 239, -0.4, 0.08}},
      {"OPENCV",
       LensModel::opencv,
       {500, 510, 322, 239, -0.1, 0.03, 1e-3, -2e-3},
       {300, 310, 322, 239, -0.3, 0.05, 1e-2, -1e-2}},
      {"OPENCV_FISHEYE",
       LensModel::opencvFisheye,
       {350, 355, 322, 239, 0.01, -0.004, 0.001, -2e-4},
       {180, 180, 322, 239, -0.03, 0.004, -0.002, 1e-4}},
      {"FULL_OPENCV",
       LensModel::fullOpencv,
       {500, 510, 322, 239, 0.2, 0.1, 1e-3, -2e-3, 0.02, 0.3, 0.15, 0.01},
       {250, 250, 322, 239, 2.5, 1.2, 1e-4, 2e-4, 0.05, 2.9, 1.9, 0.3}},
      {"FOV", LensModel::fov, {400, 400, 322, 239, 0.6}, {300, 300, 322, 239, 1.5}},
      {"SIMPLE_RADIAL_FISHEYE", LensModel::simpleRadialFisheye, {350, 322, 239, 0.02}, {180, 322, 239, -0.08}},
      {"RADIAL_FISHEYE", LensModel::radialFisheye, {350, 322, 239, 0.02, -0.01}, {180, 322, 239, -0.02, -0.01}},
      {"THIN_PRISM_FISHEYE",
       LensModel::thinPrismFisheye,
       {350, 355, 322, 239, 0.01, -0.004, 1e-3, -1e-3, 0.001, -2e-4, 5e-4, -5e-4},
       {200, 200, 322, 239, -0.04, 0.004, 5e-3, -5e-3, -0.002, 1e-4, 2e-3, 1e-3}}};
  return all;
}

Lens lensOf(LensModel model, const std::vector<double>& parameters) {
  return Lens(model, kWidth, kHeight, parameters);
}

}  // namespace

TEST_CASE("unprojecting and projecting a pixel restores it for every lens model") {
  for (const Kind& kind : kinds())
    for (const auto* parameters : {&kind.mild, &kind.strong}) {
      INFO(kind.name);
      const Lens lens = lensOf(kind.model, *parameters);
      std::size_t seen = 0;
      for (int i = 0; i <= 32; ++i)
        for (int j = 0; j <= 24; ++j) {
          const glm::dvec2 pixel(20.0 * i, 20.0 * j);  // includes the four corners
          const auto ray = lens.unproject(pixel);
          if (!ray) continue;
          ++seen;
          CHECK(glm::length(*ray) == Approx(1).epsilon(1e-14));
          const auto back = lens.project(*ray * 7.5);
          REQUIRE(back);
          CHECK(glm::distance(*back, pixel) < 1e-6);
        }
      CHECK(seen > (parameters == &kind.mild ? 33u * 25u - 1 : 300u));
      // The lens's centre looks along the axis.
      const auto axis = lens.unproject(lens.centre());
      REQUIRE(axis);
      CHECK(glm::distance(*axis, glm::dvec3(0, 0, -1)) < 1e-15);
    }
}

TEST_CASE("directions project monotonically up to the fold and not beyond it", "[N13]") {
  for (const Kind& kind : kinds()) {
    INFO(kind.name);
    const Lens lens = lensOf(kind.model, kind.strong);
    CHECK_FALSE(lens.project({0, 0, 1}));  // exactly behind the camera
    double last = -1;
    bool folded = false;
    for (int degree = 0; degree < 180; ++degree) {
      const double angle = degree / 180.0 * 3.14159265358979;
      const auto pixel = lens.project({std::sin(angle), 0, -std::cos(angle)});
      if (!pixel) folded = true;
      if (!pixel) continue;
      CHECK_FALSE(folded);  // no direction beyond the fold projects
      const double r = glm::distance(*pixel, lens.centre());
      CHECK(r > last);
      last = r;
      if (kind.model < LensModel::opencvFisheye || degree < 90) {
        const auto ray = lens.unproject(*pixel);
        REQUIRE(ray);
        CHECK(glm::distance(*ray, glm::dvec3(std::sin(angle), 0, -std::cos(angle))) < 1e-6);
      }
    }
  }
}

TEST_CASE("the fold radius is the zero of the distortion's derivative", "[N13]") {
  // r + k r³ grows up to r = 1/√(−3k), where it is 2r/3.
  const Lens lens = lensOf(LensModel::simpleRadial, {300, 320, 240, -0.25});
  const double fold = 1 / std::sqrt(0.75);
  CHECK(lens.maxRadius() == Approx(fold).epsilon(1e-9));
  CHECK(lens.project({0.999 * fold, 0, -1}));
  CHECK_FALSE(lens.project({1.001 * fold, 0, -1}));
  CHECK(lens.unproject({320 + 300 * 0.999 * fold * 2 / 3, 240}));
  CHECK_FALSE(lens.unproject({320 + 300 * 1.001 * fold * 2 / 3, 240}));
  // The fold's circle shrinks to a point as k grows without bound; the lens must still give answers.
  const Lens mad = lensOf(LensModel::simpleRadial, {300, 320, 240, -1e12});
  CHECK(mad.unproject({320, 240}));
  CHECK_FALSE(mad.unproject({330, 240}));
  // A zero of the denominator is a fold too.
  const Lens pole = lensOf(LensModel::fullOpencv, {300, 300, 320, 240, 0, 0, 0, 0, 0, -1, 0, 0});
  CHECK(pole.maxRadius() == Approx(1).epsilon(1e-9));
  CHECK_FALSE(pole.project({1.1, 0, -1}));
}

TEST_CASE("lenses without distortion are pinholes, fisheyes without distortion are equidistant") {
  const Intrinsics k{CameraModel::pinhole, kWidth, kHeight, 500, 510, 322, 239};
  for (const LensModel model : {LensModel::pinhole, LensModel::opencv, LensModel::fullOpencv, LensModel::fov}) {
    std::vector<double> parameters(parameterCount(model));
    parameters[0] = 500, parameters[1] = 510, parameters[2] = 322, parameters[3] = 239;
    const Lens lens = lensOf(model, parameters);
    CHECK_FALSE(lens.distorts());
    for (const glm::dvec3 ray : {glm::dvec3(0.3, 0.2, -1), {-5, 4, -1}, {1, 1, -1e-9}}) {
      const auto here = lens.project(ray), there = project(k, ray);
      REQUIRE(here);
      CHECK(glm::distance(*here, *there) <= 1e-12 * glm::length(*there));
    }
    CHECK(glm::distance(*lens.unproject({0, 0}), unproject(k, {0, 0})) < 1e-15);
  }
  for (const LensModel model :
       {LensModel::simpleRadialFisheye, LensModel::opencvFisheye, LensModel::thinPrismFisheye}) {
    std::vector<double> parameters(parameterCount(model));
    const bool simple = model == LensModel::simpleRadialFisheye;
    parameters[0] = 200, parameters[simple ? 1 : 2] = 322, parameters[simple ? 2 : 3] = 239;
    if (!simple) parameters[1] = 200;
    const Lens lens = lensOf(model, parameters);
    CHECK(lens.distorts());
    const auto aside = lens.project({1, 0, 0});  // 90° off the axis
    REQUIRE(aside);
    CHECK(glm::distance(*aside, glm::dvec2(322 + 200 * 1.5707963267948966, 239)) < 1e-9);
    CHECK(glm::distance(*lens.unproject(*aside), glm::dvec3(1, 0, 0)) < 1e-12);
  }
}

TEST_CASE("derivatives of the distortion match finite differences") {
  for (const Kind& kind : kinds())
    for (const auto* parameters : {&kind.mild, &kind.strong}) {
      INFO(kind.name);
      const LensDistortion l = lensOf(kind.model, *parameters).distortion();
      for (const glm::dvec2 m : {glm::dvec2(0, 0), {0.1, -0.2}, {-0.7, 0.4}, {0.9, 0.9}, {1e-9, -1e-8}}) {
        constexpr double kStep = 1e-5;
        const Distorted at = distort(l, m);
        for (int axis = 0; axis < 2; ++axis) {
          glm::dvec2 aside(0);
          aside[axis] = kStep;
          const glm::dvec2 slope = (distort(l, m + aside).point - distort(l, m - aside).point) / (2 * kStep);
          CHECK(glm::distance(slope, at.jacobian[axis]) < 1e-7);
        }
        const double r = glm::length(m);
        CHECK((radial(l, r + kStep).value - radial(l, r - kStep).value) / (2 * kStep) ==
              Approx(radial(l, r).slope).margin(1e-7));
      }
    }
}

TEST_CASE("distortion formulas match COLMAP's, computed by hand") {
  // OPENCV at (u, v) = (0.5, −0.25): r² = 0.3125.
  const double u = 0.5, v = -0.25, r2 = 0.3125, k1 = -0.2, k2 = 0.1, p1 = 0.01, p2 = 0.02;
  const double factor = 1 + k1 * r2 + k2 * r2 * r2;
  const auto pixel = lensOf(LensModel::opencv, {400, 410, 320, 240, k1, k2, p1, p2}).project({u, -v, -1});
  REQUIRE(pixel);
  CHECK(pixel->x == Approx(320 + 400 * (u * factor + 2 * p1 * u * v + p2 * (r2 + 2 * u * u))).epsilon(1e-14));
  CHECK(pixel->y == Approx(240 + 410 * (v * factor + 2 * p2 * u * v + p1 * (r2 + 2 * v * v))).epsilon(1e-14));
  // FOV (Devernay and Faugeras): r_d = atan(2 r tan(ω/2))/ω.
  const auto wide = lensOf(LensModel::fov, {400, 400, 320, 240, 0.9}).project({0.8, 0, -1});
  CHECK(wide->x == Approx(320 + 400 * std::atan(1.6 * std::tan(0.45)) / 0.9).epsilon(1e-14));
  // FULL_OPENCV's k3 follows p2 in the parameter list.
  const auto full =
      lensOf(LensModel::fullOpencv, {400, 400, 320, 240, 0, 0, 0, 0, 0.5, 0.25, 0, 0}).project({1, 0, -1});
  CHECK(full->x == Approx(320 + 400 * 1.5 / 1.25).epsilon(1e-14));
  // THIN_PRISM_FISHEYE: k3 and k4 follow p2, then the prism parameters; the polynomial is in θ.
  const double t = std::atan(0.5);
  const auto prism = lensOf(LensModel::thinPrismFisheye, {400, 400, 320, 240, 0, 0, 0, 0, 0.5, 0.25, 0.02, 0.03})
                         .project({0.5, 0, -1});
  CHECK(prism->x ==
        Approx(320 + 400 * (t * (1 + 0.5 * std::pow(t, 6) + 0.25 * std::pow(t, 8)) + 0.02 * t * t)).epsilon(1e-14));
  CHECK(prism->y == Approx(240 + 400 * 0.03 * t * t).epsilon(1e-14));
}

TEST_CASE("invalid lenses are rejected, and invalid points give no result", "[N13][N16]") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(lensOf(LensModel::opencv, {1, 1, 1, 1}), Error);
  CHECK_THROWS_AS(lensOf(LensModel::simpleRadial, {-1, 1, 1, 0}), Error);
  CHECK_THROWS_AS(lensOf(LensModel::simpleRadial, {nan, 1, 1, 0}), Error);
  CHECK_THROWS_AS(lensOf(LensModel::fov, {1, 1, 1, 1, 3.2}), Error);
  CHECK_THROWS_AS(Lens(LensModel::simplePinhole, 0, 5, std::vector<double>{1, 1, 1}), Error);
  for (const Kind& kind : kinds()) {
    const Lens lens = lensOf(kind.model, kind.strong);
    CHECK_FALSE(lens.project({0, 0, 0}));
    CHECK_FALSE(lens.project({nan, 0, -1}));
    CHECK_FALSE(lens.unproject({nan, 0}));
    CHECK_FALSE(lens.unproject({std::numeric_limits<double>::infinity(), 0}));
  }
}

TEST_CASE("a lens returns its parameters, and a written model is read with the same lenses") {
  PosedModel model;
  for (const Kind& kind : kinds()) {
    const Lens lens(kind.model, kWidth, kHeight, kind.mild);
    CHECK(parametersOf(lens) == kind.mild);
    if (!lens.distorts()) continue;
    const Camera camera{undistorted(lens), {{double(model.images.size()), 0, 0}, {1, 0, 0, 0}}};
    const auto seen = undistort(glm::dvec2(250, 200), lens, camera.intrinsics);
    REQUIRE(seen);
    model.tracks.push_back({{0, 0, -5}, {{std::uint32_t(model.images.size()), *seen}}});
    model.images.push_back({std::string(1, char('a' + model.images.size())) + ".jpg", camera, lens});
  }
  test::TemporaryFolder folder;
  writeColmapModel(model, folder / "model");
  const PosedModel read = readColmapModel(folder / "model");
  REQUIRE(read.images.size() == model.images.size());
  for (std::size_t i = 0; i < model.images.size(); ++i) {
    CHECK((read.images[i].lens == model.images[i].lens));
    CHECK(read.images[i].camera.intrinsics == model.images[i].camera.intrinsics);
    CHECK(glm::distance(read.tracks[i].observations[0].pixel, model.tracks[i].observations[0].pixel) < 1e-6);
  }
}
