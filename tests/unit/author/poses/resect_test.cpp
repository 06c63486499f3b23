// SPDX-License-Identifier: Apache-2.0
#include "ibr/author/poses.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include "support/pose_noise.h"
#include "support/posed_rig.h"

using namespace ibr;
using namespace ibr::test;

TEST_CASE("a photograph is resected to the other photographs' poses, which stay unchanged") {
  std::vector<Camera> cameras;
  for (int i = 0; i < 5; ++i)
    cameras.push_back(lookingAlong({0.5 * i, 0, 0.2 * (i % 2)}, {0.05 * (2 - i), 1, 0}, 400, 300));
  std::vector<glm::dvec3> points;
  PoseNoise random(3);
  for (int i = 0; i < 150; ++i) points.push_back(glm::dvec3(1, 6, 0) + random.vector(2));
  const PosedModel exact = modelOf(cameras, points);
  const auto off = [](const Camera& a, const Camera& b) {
    return angleBetween(a.pose.rotation, b.pose.rotation) + glm::distance(a.pose.position, b.pose.position);
  };
  // The photograph's own pose is wrong.
  PosedModel given = exact;
  given.images[2].camera = PoseNoise(1).on({cameras[2]}, 0.005, 0.02)[0];
  const auto found = resected(given, "002.png", exact);
  REQUIRE(found);
  CHECK(off(given.images[2].camera, cameras[2]) > 0.01);
  CHECK(off(*found, cameras[2]) < 1e-3);
  // The other cameras' world is turned, and their focal lengths grow: the photograph follows them.
  const SimilarityTransform move{1, glm::angleAxis(0.004, glm::dvec3(0, 0, 1)), {0.02, 0.01, 0}};
  PosedModel moved = exact;
  for (PosedImage& image : moved.images) image.camera.pose = move(image.camera.pose);
  const auto there = resected(exact, "002.png", moved);
  REQUIRE(there);
  CHECK(off(*there, moved.images[2].camera) < 1e-3);
  for (PosedImage& image : moved.images) image.camera.intrinsics.fx *= 1.01;
  CHECK(resected(exact, "002.png", moved)->intrinsics.fx == Approx(1.01 * cameras[2].intrinsics.fx));
  moved.images.erase(moved.images.begin() + 2);  // as in a model that was refined without the photograph
  CHECK(resected(exact, "002.png", moved)->intrinsics.fx == Approx(1.01 * cameras[2].intrinsics.fx));
  // Without a model of the other cameras there is no result.
  CHECK_FALSE(resected(exact, "002.png", {}));
  given.tracks.resize(10);
  CHECK_FALSE(resected(given, "002.png", exact));
}
