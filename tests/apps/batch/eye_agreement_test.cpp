// SPDX-License-Identifier: Apache-2.0
// Two eyes in front of a wall whose colours depend only on the surface position.
#include "batch/evaluate/eye_agreement.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace ibr;
using namespace ibr::app;

namespace {

constexpr double kWall = 4;  // distance of the wall

Camera eyeAt(double x) {
  return {pinholeFromFov(96, 72, 0.9), {{x, 0, 0}, {1, 0, 0, 0}}};
}

// Image of a wall at z = −kWall: smooth in the world's x and y. `lighter`: added 8-bit levels.
SceneRenderer::Picture wallFrom(const Camera& eye, double lighter = 0) {
  const Intrinsics& lens = eye.intrinsics;
  SceneRenderer::Picture picture{.image = Image8(lens.width, lens.height, 4, 255), .buffers = FrameBuffers{}};
  picture.buffers->surface = ImageF(lens.width, lens.height, 4);
  for (int y = 0; y < lens.height; ++y)
    for (int x = 0; x < lens.width; ++x) {
      const glm::dvec3 ray = unproject(lens, {x + 0.5, y + 0.5});
      const glm::dvec3 place = eye.pose.position + ray * (kWall / -ray.z);
      const double level = 120 + 40 * std::sin(2 * place.x) + 30 * std::cos(3 * place.y) + lighter;
      for (std::size_t c = 0; c < 3; ++c) picture.image.pixel(x, y)[c] = std::uint8_t(std::lround(level));
      picture.buffers->surface.pixel(x, y)[0] = float(kWall);
    }
  return picture;
}

}  // namespace

TEST_CASE("eyes in front of one wall agree, and points outside the other image are not compared") {
  const Camera left = eyeAt(-0.1), right = eyeAt(0.1);
  const EyeAgreement found = eyeAgreement(wallFrom(left), left, wallFrom(right), right);
  const double columns = 0.2 * left.intrinsics.fx / kWall;  // disparity, px
  CHECK(found.seenByBoth == Approx(1 - columns / 96).margin(0.03));
  CHECK(found.sameCell == 1);
  CHECK(found.difference < 0.5);  // levels are integers, and positions lie between pixels
  CHECK(found.difference95 < 1.5);
}

TEST_CASE("eye agreement reports differences of colours, cells and tiers") {
  const Camera left = eyeAt(-0.1), right = eyeAt(0.1);
  const EyeAgreement lighter = eyeAgreement(wallFrom(left), left, wallFrom(right, 10), right);
  CHECK(lighter.difference == Approx(10).margin(0.3));
  CHECK(lighter.difference95 == Approx(10).margin(1.5));
  SceneRenderer::Picture other = wallFrom(right);
  for (int y = 36; y < 72; ++y)
    for (int x = 0; x < 96; ++x) other.buffers->surface.pixel(x, y)[y < 54 ? 2 : 1] = 1;  // rank, then tier
  CHECK(eyeAgreement(wallFrom(left), left, other, right).sameCell == Approx(0.5).margin(0.02));
}

TEST_CASE("eye agreement leaves out points that one eye does not see or that have no known depth") {
  const Camera left = eyeAt(-0.1), right = eyeAt(0.1);
  const auto with = [&](float depth, float rank) {
    SceneRenderer::Picture picture = wallFrom(right);
    for (int y = 0; y < 72; ++y)
      for (int x = 0; x < 96; ++x) {
        picture.buffers->surface.pixel(x, y)[0] = depth;
        picture.buffers->surface.pixel(x, y)[2] = rank;
      }
    return picture;
  };
  for (const auto& [depth, rank] : {std::pair{2.0f, 0.0f}, {INFINITY, 0.0f}, {NAN, 0.0f}, {4.0f, -1.0f}}) {
    const SceneRenderer::Picture hidden = with(depth, rank);
    const EyeAgreement found = eyeAgreement(wallFrom(left), left, hidden, right);
    CHECK(found.seenByBoth == 0);
    CHECK(std::isnan(found.difference));
    CHECK(std::isnan(found.sameCell));
    CHECK(eyeAgreement(hidden, right, wallFrom(left), left).seenByBoth == 0);
  }
}
