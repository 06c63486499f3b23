// SPDX-License-Identifier: Apache-2.0
#include "author/graph/view_relations.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "author/geometry/posed_model.h"
#include "support/posed_rig.h"

using namespace ibr;
using namespace ibr::test;

TEST_CASE("shared points of two photographs are counted once each and symmetrically") {
  const std::vector<Camera> cameras{lookingAlong({0, 0, 0}, {0, 1, 0}), lookingAlong({1, 0, 0}, {0, 1, 0}),
                                    lookingAlong({0, 0, 0}, {0, -1, 0})};
  PosedModel model = modelOf(cameras, pointsAround({0, 0, 0}, 20, 3000));
  std::size_t expected = 0, first = 0, second = 0;
  for (Track& track : model.tracks) {
    bool sees[3] = {};
    for (const TrackObservation& o : track.observations) sees[o.image] = true;
    first += sees[0];
    second += sees[1];
    expected += sees[0] && sees[1];
    track.observations.push_back(track.observations[0]);  // one image observes the point twice
  }
  const ViewRelations relations(model);
  const ViewRelation& relation = relations.between(1, 0);
  CHECK(relation.shared == expected);
  CHECK(relation.fewerTracks == std::min(first, second));
  CHECK(relation.covisible() == Approx(double(expected) / double(std::min(first, second))));
  CHECK(&relation == &relations.between(0, 1));
  CHECK(relations.between(0, 2).shared == 0);
  CHECK(relations.between(0, 2).covisible() == 0);
  CHECK(relations.between(0, 2).axisAngle == Approx(3.14159265).epsilon(1e-6));
  CHECK(relations.neighbours(0, 1) ==
        std::vector<std::pair<std::uint32_t, std::uint32_t>>{{1, std::uint32_t(expected)}});
  CHECK(relations.neighbours(0, std::uint32_t(expected) + 1).empty());
}

TEST_CASE("disparity spread is relative to the image width at any world scale") {
  const double scale = GENERATE(1.0, 1e-3, 1e5);
  const std::vector<Camera> cameras{lookingAlong({0, 0, 0}, {0, 1, 0}), lookingAlong({0.2 * scale, 0, 0}, {0, 1, 0})};
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 100; ++i)  // half of the points near, half far
    points.push_back(scale * glm::dvec3(0.1 + 0.002 * i, i % 2 ? 4.0 : 40.0, 0.003 * i));
  const PosedModel model = modelOf(cameras, points);
  const Intrinsics& k = cameras[0].intrinsics;
  const double near = 0.2 / 4 * k.fx / k.width, far = 0.2 / 40 * k.fx / k.width;
  CHECK(ViewRelations(model).between(0, 1).disparitySpread == Approx(near - far).epsilon(0.02));
}

TEST_CASE("cameras are matched at two megapixels at most with an unchanged field of view") {
  const Camera small = lookingAlong({0, 0, 0}, {0, 1, 0}), large = lookingAlong({0, 0, 0}, {0, 1, 0}, 6000, 4000);
  CHECK(matchedCamera(small).intrinsics.width == small.intrinsics.width);
  const Intrinsics k = matchedCamera(large).intrinsics;
  CHECK(double(k.width) * k.height <= kMatchPixels);
  CHECK(double(k.width) * k.height > 0.99 * kMatchPixels);
  CHECK(k.fx / k.width == Approx(large.intrinsics.fx / large.intrinsics.width));
}
