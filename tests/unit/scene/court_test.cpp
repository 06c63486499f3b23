// SPDX-License-Identifier: Apache-2.0
#include "lab/generate/court.h"

#include <catch2/catch.hpp>
#include <glm/geometric.hpp>

#include "ibr/error.h"

using namespace ibr;

TEST_CASE("photographs of a court equal renderings of all its planes") {
  const Court court = makeCourt(30, 48, 36, 1);
  SyntheticScene all;
  all.planes = court.planes;
  for (const std::size_t i : {0u, 7u, 29u})
    CHECK((photograph(court, court.cameras[i], 1) == renderTruth(all, court.cameras[i], 1)));
  const Camera between = cameraInCourt(court, 0.99);
  CHECK((photograph(court, between, 1) == renderTruth(all, between, 1)));
}

TEST_CASE("the distance of neighbours in a court does not depend on their number") {
  for (const int count : {24, 200}) {
    const Court court = makeCourt(count, 48, 36, 1);
    REQUIRE(court.cameras.size() == std::size_t(count));
    for (std::size_t i = 0; i < court.cameras.size(); ++i) {
      const Camera &camera = court.cameras[i], &next = court.cameras[(i + 2) % court.cameras.size()];  // same row
      CHECK(glm::distance(camera.pose.position, next.pose.position) < 1.7);  // the back row widens at corners
      CHECK(glm::dot(viewAxis(camera.pose), viewAxis(next.pose)) > (count == 200 ? 0.94 : -0.1));
    }
  }
}

TEST_CASE("tracks of a court project to their pixels and are not occluded") {
  const Court court = makeCourt(24, 80, 60, 3);
  SyntheticScene all;
  all.planes = court.planes;
  const auto tracks = tracksOf(court, 3);
  std::vector<int> seen(court.cameras.size());
  for (const CourtTrack& track : tracks) {
    REQUIRE(track.seen.size() >= 2);
    for (const auto& [i, pixel] : track.seen) {
      ++seen[i];
      const Camera& camera = court.cameras[i];
      const glm::dvec3 to = track.position - camera.pose.position;
      const auto at = project(camera.intrinsics, glm::conjugate(camera.pose.rotation) * to);
      REQUIRE(at);
      REQUIRE(glm::distance(*at, pixel) < 1e-9);
      REQUIRE((pixel.x > 0 && pixel.y > 0 && pixel.x < 80 && pixel.y < 60));
      REQUIRE(distanceAlong(all, camera.pose.position, to).value() == Approx(1));
    }
  }
  for (const int count : seen) CHECK(count > 100);
}

TEST_CASE("a court is deterministic for a seed") {
  const auto picture = [](std::uint64_t seed) {
    const Court court = makeCourt(10, 32, 24, seed);
    return photograph(court, court.cameras[3], 1);
  };
  CHECK((picture(1) == picture(1)));
  CHECK((picture(1) != picture(2)));
  CHECK_THROWS_AS(makeCourt(1, 32, 24, 1), Error);
}
