// SPDX-License-Identifier: Apache-2.0
#include "author/match/frame_depth.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <numbers>
#include <vector>

#include "ibr/error.h"
#include "support/error_of.h"

using namespace ibr;

namespace {

constexpr double kStep = 0.01;  // ρ of a level
constexpr double kWall = 4, kPole = 2;

// Distance along a ray to a wall, or to a pole 0.4 units wide in front of the wall; the cameras look along −z.
double wallAndPole(const Camera& camera, glm::dvec3 direction) {
  const glm::dvec3 d = camera.pose.rotation * direction;
  const auto along = [&](double z) { return (-z - camera.pose.position.z) / d.z; };
  const double x = camera.pose.position.x + along(kPole) * d.x;
  return std::abs(x) < 0.2 ? along(kPole) : along(kWall);
}
double wallAlone(const Camera& camera, glm::dvec3 direction) {
  const glm::dvec3 d = camera.pose.rotation * direction;
  return (-kWall - camera.pose.position.z) / d.z;
}

template <class Distance>
MemberDepth memberAt(glm::dvec3 position, Distance&& distance, glm::dquat turn = {1, 0, 0, 0}) {
  MemberDepth member{{pinholeFromFov(80, 60, 1.0), {position, turn}}, ImageF(80, 60, 1), kStep};
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 80; ++x) {
      const glm::dvec3 ray = unproject(member.camera.intrinsics, {x + 0.5, y + 0.5});
      member.inverseDepth.pixel(x, y)[0] = float(1 / distance(member.camera, ray / -ray.z));
    }
  return member;
}

Camera frameAt(glm::dvec3 position) {
  return {pinholeFromFov(64, 48, 0.6), {position, {1, 0, 0, 0}}};
}

}  // namespace

TEST_CASE("a wall that both members see has its depth in the frame, and both agree") {
  const std::vector members{memberAt({-0.3, 0, 0}, wallAlone), memberAt({0.3, 0.1, 0.2}, wallAlone)};
  const FrameDepth depth = depthOfFrame(frameAt({0, 0, 0.1}), members, kStep);
  for (const float w : depth.inverseDepth.values) CHECK(w == Approx(1 / (kWall + 0.1)).epsilon(1e-5));
  CHECK(std::ranges::count(depth.agree.values, std::uint8_t(3)) == std::ptrdiff_t(depth.agree.values.size()));
}

TEST_CASE("a pole has its own depth in the frame, without depths between pole and wall at its outline") {
  const std::vector members{memberAt({-0.3, 0, 0}, wallAndPole), memberAt({0.3, 0, 0}, wallAndPole)};
  const Camera frame = frameAt({0, 0, 0});
  const FrameDepth depth = depthOfFrame(frame, members, kStep);
  std::size_t pole = 0;
  for (const float w : depth.inverseDepth.values) {
    const bool isPole = std::abs(double(w) - 1 / kPole) < 1e-4;
    pole += isPole;
    CHECK((isPole || std::abs(double(w) - 1 / kWall) < 1e-4));
  }
  const double expected = 0.4 / kPole * frame.intrinsics.fx * 48;
  CHECK(double(pole) == Approx(expected).epsilon(0.15));
  CHECK(depth.agree.pixel(32, 24)[0] == 3);
}

TEST_CASE("the depth of a single member is outvoted by two others") {
  const std::vector members{memberAt({-0.3, 0, 0}, wallAlone), memberAt({0, 0.1, 0}, wallAndPole),
                            memberAt({0.3, 0, 0}, wallAlone)};
  const FrameDepth depth = depthOfFrame(frameAt({0, 0, 0}), members, kStep);
  CHECK(depth.inverseDepth.pixel(32, 24)[0] == Approx(1 / kWall).epsilon(1e-4));
  CHECK(depth.agree.pixel(32, 24)[0] == 5);
  CHECK(depth.agree.pixel(2, 24)[0] == 7);
}

TEST_CASE("unknown depth is filled from the farther side, and no member agrees on it") {
  std::vector members{memberAt({0, 0, 0}, wallAndPole)};
  for (int y = 0; y < 60; ++y)
    for (int x = 20; x < 40; ++x) members[0].inverseDepth.pixel(x, y)[0] = -1;
  const FrameDepth depth = depthOfFrame(frameAt({0, 0, 0}), members, kStep);
  CHECK(depth.agree.pixel(25, 24)[0] == 0);
  CHECK(depth.inverseDepth.pixel(25, 24)[0] == Approx(1 / kWall).epsilon(1e-4));
  std::ranges::fill(members[0].inverseDepth.values, -1.0f);
  const FrameDepth nothing = depthOfFrame(frameAt({0, 0, 0}), members, kStep);
  for (const float w : nothing.inverseDepth.values) CHECK(w == 0);
}

TEST_CASE("sky is at infinity in the frame") {
  const auto sky = [](const Camera&, glm::dvec3) { return std::numeric_limits<double>::infinity(); };
  const FrameDepth depth =
      depthOfFrame(frameAt({0, 0, 0}), std::vector{memberAt({-0.3, 0, 0}, sky), memberAt({0.3, 0, 0}, sky)}, kStep);
  for (const float w : depth.inverseDepth.values) CHECK(w == 0);
  for (const std::uint8_t who : depth.agree.values) CHECK(who == 3);
}

TEST_CASE("a panorama's depth has no gap at its seam") {
  constexpr double kRadius = 3;
  MemberDepth member{{{CameraModel::equirectangular, 128, 64}, {{0, 0, 0}, {1, 0, 0, 0}}},
                     ImageF(128, 64, 1, float(1 / kRadius)),
                     kStep};
  for (const double turn : {0.0, 0.5, 1.0, 1.5}) {
    Camera frame = frameAt({0, 0, 0});
    frame.pose.rotation = glm::angleAxis(turn * std::numbers::pi, glm::dvec3(0, 1, 0));
    const FrameDepth depth = depthOfFrame(frame, std::vector{member}, kStep);
    CHECK(std::ranges::count(depth.agree.values, std::uint8_t(1)) == std::ptrdiff_t(depth.agree.values.size()));
    CHECK(depth.inverseDepth.pixel(32, 24)[0] == Approx(1 / kRadius).epsilon(1e-3));
  }
}

TEST_CASE("the world's pose and the order of members do not change the frame's depth") {
  const std::vector members{memberAt({-0.3, 0, 0}, wallAndPole), memberAt({0.3, 0, 0}, wallAndPole)};
  const FrameDepth here = depthOfFrame(frameAt({0, 0, 0}), members, kStep),
                   swapped = depthOfFrame(frameAt({0, 0, 0}), std::vector{members[1], members[0]}, kStep);
  CHECK(swapped.inverseDepth.values == here.inverseDepth.values);
  const glm::dquat turn = glm::normalize(glm::dquat(0.9, 0.1, -0.3, 0.2));
  const glm::dvec3 shift(100, -20, 7);
  const auto moved = [&](Camera camera) {
    camera.pose.position = turn * camera.pose.position + shift;
    camera.pose.rotation = turn * camera.pose.rotation;
    return camera;
  };
  std::vector there = members;
  for (MemberDepth& member : there) member.camera = moved(member.camera);
  const FrameDepth elsewhere = depthOfFrame(moved(frameAt({0, 0, 0})), there, kStep);
  std::size_t different = 0;
  for (std::size_t p = 0; p < here.inverseDepth.values.size(); ++p)
    different += std::abs(here.inverseDepth.values[p] - elsewhere.inverseDepth.values[p]) > 1e-5f;
  CHECK(different < 20);  // pixels on the outline may get either depth
}

TEST_CASE("more members than a cell has are rejected") {
  const std::vector<MemberDepth> members(5, memberAt({0, 0, 0}, wallAlone));
  CHECK(test::errorOf([&] { depthOfFrame(frameAt({0, 0, 0}), members, kStep); }).code() == ErrorCode::invalidInput);
}
