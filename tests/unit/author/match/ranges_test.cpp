// SPDX-License-Identifier: Apache-2.0
#include "author/match/ranges.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "author/geometry/mean_frame.h"
#include "support/posed_rig.h"

using namespace ibr;
using namespace ibr::test;

namespace {

const std::vector<Camera> kRig{
    lookingAlong({0, 0, 1.5}, {0, 1, 0}, 800, 600), lookingAlong({1, 0, 1.4}, {0.1, 1, 0}, 600, 800),
    lookingAlong({0.4, 0.9, 1.6}, {0, 1, 0.05}, 800, 600), lookingAlong({0.3, 0.2, 2.4}, {0, 1, 0}, 800, 600)};

glm::dvec2 pixelOf(const Camera& camera, glm::dvec3 point) {
  return project(camera.intrinsics, glm::inverse(camera.pose.rotation) * (point - camera.pose.position)).value();
}
glm::dvec3 rayOf(const Camera& camera, glm::dvec2 pixel) {
  return camera.pose.rotation * unproject(camera.intrinsics, pixel);
}

}  // namespace

TEST_CASE("exact matches give exact ranges, for any position of the world and any prior") {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const glm::dvec3 offset = GENERATE(glm::dvec3(0.0), glm::dvec3(5e5, 6e6, 100));
  const double unit = GENERATE(1.0, 1e-3, 1e3);
  for (std::size_t d = 2; d <= 4; ++d) {
    std::vector<Camera> members(kRig.begin(), kRig.begin() + std::ptrdiff_t(d));
    for (Camera& member : members) member.pose.position = offset + unit * member.pose.position;
    const Camera frame = meanFrame(members);
    for (int round = 0; round < 100; ++round) {
      const double depth = 2.5 * std::pow(10.0, 1.0 + uniform(random));
      const glm::dvec3 point =
          offset + unit * glm::dvec3(0.4 + 0.3 * depth * uniform(random), depth, 1.5 + 0.2 * depth * uniform(random));
      std::vector<glm::dvec2> pixels;
      double mean = 0;
      for (const Camera& member : members) {
        pixels.push_back(pixelOf(member, point));
        mean += glm::distance(point, member.pose.position) / double(d);
      }
      const double truth = inverseDepth(frame, point);
      const RangeFit range =
          triangulate(frame, members, pixels, {truth * (1 + 0.2 * uniform(random)), 10 / unit}, 0.25);
      const double tolerance = offset == glm::dvec3(0.0) ? 1e-7 : 1e-4;
      CHECK(range.inverseDistance * mean == Approx(1).epsilon(tolerance));
      CHECK(range.residualPx < 1e-3);
      CHECK(range.uncertainty > 0);
      for (std::size_t i = 0; i < d; ++i)
        CHECK(range.ratio[i] == Approx(glm::distance(point, members[i].pose.position) / mean).epsilon(tolerance));
    }
  }
}

TEST_CASE("parallel and diverging rays lie at infinity, with equal ratios") {
  const std::vector<Camera> members(kRig.begin(), kRig.begin() + 3);
  const Camera frame = meanFrame(members);
  const glm::dvec3 direction = glm::normalize(glm::dvec3(0.1, 1, 0.05));
  std::vector<glm::dvec2> parallel;
  for (const Camera& member : members) parallel.push_back(pixelOf(member, member.pose.position + direction));
  for (const double priorDepth : {0.0, 1e-3}) {
    const RangeFit range = triangulate(frame, members, parallel, {priorDepth, 1.0}, 0.25);
    CHECK(range.inverseDistance == Approx(0).margin(1e-6));
    for (const double a : range.ratio) CHECK(a == Approx(1).margin(1e-6));
  }
  // The closest point of these rays is behind the cameras.
  std::vector<glm::dvec2> parting = parallel;
  parting[0].x -= 3;
  parting[1].x += 3;
  const RangeFit range = triangulate(frame, members, parting, {0.01, 0.1}, 0.25);
  CHECK(range.inverseDistance == 0);
  CHECK(std::isfinite(range.uncertainty));
  CHECK(range.uncertainty > 0);
  for (const double a : range.ratio) CHECK(a == 1);
}

TEST_CASE("the prior decides where rays do not determine a range, and the uncertainty reflects noise") {
  // The epipole: straight-ahead motion does not shift this point, so its rays give no depth.
  const std::vector<Camera> forward{lookingAlong({0, 0, 0}, {0, 1, 0}, 800, 600),
                                    lookingAlong({0, 1, 0}, {0, 1, 0}, 800, 600)};
  const Camera frame = meanFrame(forward);
  const glm::dvec3 ahead(0, 9, 0);
  const std::vector<glm::dvec2> pixels{pixelOf(forward[0], ahead), pixelOf(forward[1], ahead)};
  const double truth = inverseDepth(frame, ahead);
  const RangeFit range = triangulate(frame, forward, pixels, {truth, 0.01}, 0.25);
  CHECK(range.inverseDistance == Approx(1 / 8.5).epsilon(1e-6));
  CHECK(range.uncertainty == Approx(0.01).epsilon(0.05));

  // The truth nearly always lies within three sigma, and not always within one sigma.
  const std::vector<Camera> members(kRig.begin(), kRig.begin() + 3);
  const Camera mean = meanFrame(members);
  std::mt19937_64 random(2);
  std::normal_distribution<double> noise(0, 0.5);
  int within1 = 0, within3 = 0;
  constexpr int kRounds = 500;
  for (int round = 0; round < kRounds; ++round) {
    const glm::dvec3 point(0.5, 8, 1);
    std::vector<glm::dvec2> noisy;
    double distance = 0;
    for (const Camera& member : members) {
      noisy.push_back(pixelOf(member, point) + glm::dvec2(noise(random), noise(random)));
      distance += glm::distance(point, member.pose.position) / 3;
    }
    const RangeFit found = triangulate(mean, members, noisy, {0.1, 10.0}, 0.5);
    const double error = std::abs(found.inverseDistance - 1 / distance);
    within1 += error < found.uncertainty;
    within3 += error < 3 * found.uncertainty;
  }
  CHECK(within3 > 0.97 * kRounds);
  CHECK(within1 > 0.5 * kRounds);
  CHECK(within1 < 0.97 * kRounds);
}

TEST_CASE("the morph reproduces a member's pixel at its pose, whatever the match") {
  const std::vector<Camera> members(kRig.begin(), kRig.begin() + 3);
  const Camera frame = meanFrame(members);
  const std::vector<glm::dvec2> pixels{{400, 300}, {330, 380}, {370, 290}};  // skew rays
  const RangeFit range = triangulate(frame, members, pixels, {0.1, 0.05}, 0.25);
  for (std::size_t i = 0; i < 3; ++i) {
    // With λ = e_i and p = c_i, the morph's direction is D = a_i r_i + ρ (c_i − c_i).
    const glm::dvec3 direction = range.ratio[i] * rayOf(members[i], pixels[i]);
    CHECK(range.ratio[i] > 0);
    CHECK(glm::distance(pixelOf(members[i], members[i].pose.position + direction), pixels[i]) < 1e-9);
  }
}

TEST_CASE("the mean frame is symmetric in the members, and its pixels map to theirs") {
  std::vector<Camera> members(kRig.begin(), kRig.end());
  const Camera frame = meanFrame(members);
  std::reverse(members.begin(), members.end());
  const Camera other = meanFrame(members);
  CHECK(glm::distance(frame.pose.position, other.pose.position) < 1e-12);
  CHECK(std::abs(glm::dot(frame.pose.rotation, other.pose.rotation)) == Approx(1).epsilon(1e-12));
  CHECK(frame.intrinsics.width == other.intrinsics.width);
  CHECK(frame.intrinsics.height == other.intrinsics.height);

  const glm::dvec3 point(0.7, 6, 1.2);
  const glm::dvec2 seen = pixelOf(frame, point);
  for (const Camera& member : members) {
    const auto pixel = frameToMember(frame, member)(seen, inverseDepth(frame, point));
    REQUIRE(pixel);
    CHECK(glm::distance(*pixel, pixelOf(member, point)) < 1e-8);
  }
  // Cameras rolled by half a turn against each other have no common up vector: one camera's up is used.
  const std::vector<Camera> rolled{lookingAlong({0, 0, 0}, {0, 1, 0}, 200, 150, 0.9, {0, 0, 1}),
                                   lookingAlong({1, 0, 0}, {0, 1, 0}, 200, 150, 0.9, {0, 0, -1})};
  const Camera upright = meanFrame(rolled);
  CHECK(glm::distance(viewAxis(upright.pose), glm::dvec3(0, 1, 0)) < 1e-12);
  CHECK(std::isfinite(upright.pose.rotation.w));
  // The mean frame of one camera is the camera.
  const Camera alone = meanFrame(std::span(kRig).first(1));
  CHECK(alone.intrinsics.width == 800);
  CHECK(glm::distance(pixelOf(alone, point), pixelOf(kRig[0], point)) < 1e-6);
}
