// SPDX-License-Identifier: Apache-2.0
#include "lab/generate/hand_held_walk.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/geometric.hpp>

#include "ibr/error.h"
#include "lab/generate/surface_renderer.h"
#include "lab/generate/walk_hall.h"

using namespace ibr;

TEST_CASE("jolts blur a known quarter of the frames, whichever frames are taken, and no frame beside them") {
  for (const bool variableRate : {false, true})
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
      const HandHeldWalk walk({60, 30, 0.008, variableRate, 1.1, seed});
      const auto& times = walk.frameTimes();
      const auto& jolted = walk.jolted();
      REQUIRE(times.size() == 1800);
      REQUIRE(jolted.size() == times.size());
      CHECK(times[0] == 0);
      for (const std::size_t n : {1u, 5u, 6u, 10u, 15u, 20u, 30u}) {
        double chosen = 0, blurred = 0;
        for (std::size_t i = 0; i < times.size(); i += n, ++chosen) blurred += jolted[i];
        INFO("every " << n << "th");
        CHECK(blurred / chosen > 0.2);
        CHECK(blurred / chosen < 0.36);
      }
      std::size_t run = 0, longest = 0;
      for (std::size_t i = 0; i < times.size(); ++i) {
        run = jolted[i] ? run + 1 : 0;
        longest = std::max(longest, run);
        const double turned =
            angleBetween(walk.poseAt(times[i] - 0.004).rotation, walk.poseAt(times[i] + 0.004).rotation);
        if (jolted[i])
          CHECK(turned > 0.017);  // 10 px of 640
        else
          CHECK(turned < 0.012);
      }
      CHECK(longest == 5);
    }
}

TEST_CASE("the walk has slow and fast parts, a stop and a turn, and stays where there is room") {
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
    const HandHeldWalk walk({60, 30, 0.008, false, 1.1, seed});
    const WalkHall hall = makeWalkHall(seed);
    double slowest = 1, fastest = 0, turned = 0;
    for (std::size_t i = 0; i < walk.frameTimes().size(); ++i) {
      const double time = walk.frameTimes()[i];
      CHECK(hall.hasRoom(walk.poseAt(time).position));
      slowest = std::min(slowest, walk.speedAt(time));
      fastest = std::max(fastest, walk.speedAt(time));
      // The speed along the way is that of the position.
      const double moved =
          glm::length(walk.steadyPoseAt(time + 0.01).position - walk.steadyPoseAt(time - 0.01).position) / 0.02;
      if (time > 0.01) CHECK(moved == Approx(walk.speedAt(time)).margin(0.02));
      if (walk.speedAt(time) == 0 && i > 0)
        turned += angleBetween(walk.steadyPoseAt(walk.frameTimes()[i - 1]).rotation, walk.steadyPoseAt(time).rotation);
    }
    CHECK(slowest == 0);
    CHECK(fastest > 1);
    CHECK(turned > 3);
    CHECK(walk.parts().size() == 7);
  }
}

TEST_CASE("walks without frames, and exposures that reach into the next frame, are refused") {
  CHECK_THROWS_AS(HandHeldWalk({0.1, 30}), Error);
  CHECK_THROWS_AS(HandHeldWalk({60, 30, 0.02}), Error);
}

TEST_CASE("a rendered surface has exact depth and the colour of its texture, and hides what is behind it") {
  const Surface wall{{0, 0, -4}, {1, 0, 0}, {0, 1, 0}, 6, 5, Material::brick, 3};
  const double turn = 0.5;
  const Surface board{{0.4, 0.1, -2}, {std::cos(turn), 0, std::sin(turn)}, {0, 1, 0}, 1, 1.2, Material::poster, 5};
  const Surface behind{{0, 0, 3}, {1, 0, 0}, {0, 1, 0}, 1, 1, Material::cloth, 4};
  constexpr double kDensity = 150;
  const SurfaceRenderer renderer({wall, board, behind}, kDensity, 2);
  const Camera camera{pinholeFromFov(64, 48, 0.8), {{0.1, 0.2, 0.3}, glm::angleAxis(0.1, glm::dvec3(0.6, 0.8, 0))}};
  const ImageF inverse = renderer.inverseDepth(camera);
  ImageF sum(64, 48, 3);
  renderer.addSamples(camera, {0.5, 0.5}, sum);
  int onBoard = 0, near = 0;
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x) {
      const glm::dvec3 local = unproject(camera.intrinsics, {x + 0.5, y + 0.5}), ray = camera.pose.rotation * local;
      double first = 1e9;
      const Surface* seen = nullptr;
      glm::dvec2 at(0);
      for (const Surface* s : {&wall, &board, &behind}) {
        const glm::dvec3 normal = glm::cross(s->u, s->v);
        const double t = glm::dot(normal, s->origin - camera.pose.position) / glm::dot(normal, ray);
        const glm::dvec3 offset = camera.pose.position + t * ray - s->origin;
        const glm::dvec2 here(glm::dot(offset, s->u), glm::dot(offset, s->v));
        if (t <= 0 || t > first || std::abs(here.x) > s->extentU / 2 || std::abs(here.y) > s->extentV / 2) continue;
        first = t;
        seen = s;
        at = here;
      }
      REQUIRE(seen);
      CHECK(1 / inverse.pixel(x, y)[0] == Approx(first * -local.z).epsilon(1e-5));
      onBoard += seen == &board;
      // The texture is finer than pixels: the mean over the pixel, as the mip level gives, is compared.
      glm::dvec3 mean(0);
      const double size = first / camera.intrinsics.fx;
      for (int i = 0; i < 64; ++i)
        mean += glm::dvec3(surfaceColour(*seen, at + size * (sampleOffset(std::size_t(i)) - 0.5), 1 / kDensity)) / 64.0;
      near += std::abs(sum.pixel(x, y)[1] - mean.y) < 0.08;
    }
  CHECK(onBoard > 300);
  CHECK(onBoard < 1500);
  CHECK(near > 0.85 * 64 * 48);
}

TEST_CASE("a renderer reports finished textures, and stops when it is told to") {
  const WalkHall hall = makeWalkHall(2);
  std::size_t last = 0;
  const SurfaceRenderer renderer(hall.surfaces, 2, 2, [&](std::size_t done) {
    last = done;
    return true;
  });
  CHECK(last == hall.surfaces.size());
  try {
    const SurfaceRenderer stopped(hall.surfaces, 2, 2, [](std::size_t) { return false; });
    FAIL("was not stopped");
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::cancelled);
  }
}

TEST_CASE("the hall is closed: every pixel of every view shows a surface") {
  const WalkHall hall = makeWalkHall(2);
  const SurfaceRenderer renderer(hall.surfaces, 2, 2);
  const HandHeldWalk walk({60, 30, 0.008, false, 1.1, 2});
  for (std::size_t i = 0; i < walk.frameTimes().size(); i += 30) {
    const ImageF inverse = renderer.inverseDepth({pinholeFromFov(40, 24, 0.7), walk.poseAt(walk.frameTimes()[i])});
    CHECK(*std::ranges::min_element(inverse.values) > 0.05f);
    CHECK(*std::ranges::max_element(inverse.values) < 4.0f);
  }
}
