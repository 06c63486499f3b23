// SPDX-License-Identifier: Apache-2.0
#include "author/htm/htm_adjust.h"

#include <catch2/catch.hpp>
#include <cmath>

#include "htm_object.h"
#include "support/test_meshes.h"

namespace ibr {

using test::lookingAt;
using test::plainView;

TEST_CASE("offsets correct a camera with a wrong pose and a wrong focal length") {
  for (const glm::dvec3& middle : {glm::dvec3(0), glm::dvec3(1e6, -1e6, 2e6)}) {
    const TriangleMesh mesh = test::moved(test::sphere(16), middle);
    const std::size_t n = mesh.positions.size();
    for (int kind = 0; kind < 4; ++kind) {
      INFO(kind << " " << middle.x);
      const Camera truly = lookingAt(middle + glm::dvec3(0.6, 0.5, 2.2), middle, 320, 240);
      HtmView view = plainView(truly);
      if (kind & 1) view.camera = test::disturbed(truly, 0.01, 0.02, 1);
      if (kind & 2) view.camera.intrinsics.fx *= 1.03, view.camera.intrinsics.fy *= 1.03;
      std::vector<CameraSet> members(n);
      std::vector<glm::vec2> offsets(n);
      for (std::size_t v = 0; v < n; ++v) {
        members[v] = glm::dot(mesh.positions[v] - middle, glm::dvec3(0.6, 0.5, 2.2)) > 1.0;
        offsets[v] = members[v] ? glm::vec2(PinholeView(truly).seen(mesh.positions[v])->pixel -
                                            PinholeView(view.camera).seen(mesh.positions[v])->pixel)
                                : glm::vec2(1e5f);
      }
      const AdjustedCamera found = adjustedCameras(mesh, {&view, 1}, members, offsets).front();
      CHECK(found.afterPx < 0.05);
      if (kind == 0) continue;
      CHECK(found.adjusted);
      CHECK(found.beforePx > 0.5);
      double most = 0;
      for (std::size_t v = 0; v < n; ++v)
        if (members[v])
          most = std::max(most, glm::distance(PinholeView(truly).seen(mesh.positions[v])->pixel,
                                              PinholeView(found.camera).seen(mesh.positions[v])->pixel));
      CHECK(most < 0.1);
      CHECK(found.camera.intrinsics.fx == Approx(truly.intrinsics.fx).epsilon(1e-3));
      CHECK(glm::distance(found.camera.pose.position, truly.pose.position) < 0.01);
      CHECK(found.camera.intrinsics.cx == view.camera.intrinsics.cx);
      CHECK(found.camera.intrinsics.fx / found.camera.intrinsics.fy ==
            Approx(view.camera.intrinsics.fx / view.camera.intrinsics.fy));
      CHECK(glm::length(found.camera.pose.rotation) == Approx(1));
    }
  }
}

TEST_CASE("a camera with too few or no vertices is not adjusted") {
  const TriangleMesh mesh = test::sphere(16);
  const std::vector<HtmView> views{plainView(lookingAt({0, 0, 4}, {0, 0, 0})),
                                   plainView(lookingAt({0, 0, 4}, {0, 0, 8})),
                                   plainView(lookingAt({4, 0, 0}, {0, 0, 0}))};
  std::vector<CameraSet> members(mesh.positions.size(), 2);
  for (std::size_t v = 0; v < 39; ++v) members[v] |= 1;
  const std::vector<glm::vec2> offsets(3 * members.size(), glm::vec2(2, 1));
  for (const AdjustedCamera& found : adjustedCameras(mesh, views, members, offsets)) CHECK(!found.adjusted);
  const auto found = adjustedCameras(mesh, views, members, offsets);
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(found[i].camera.pose.position == views[i].camera.pose.position);
    CHECK(found[i].camera.intrinsics == views[i].camera.intrinsics);
    CHECK(std::isfinite(found[i].afterPx));
    CHECK(!found[i].known);
  }
  CHECK(found[0].beforePx == Approx(std::sqrt(5)));  // reported even if the camera is not adjusted
  CHECK(found[0].afterPx == found[0].beforePx);
  members[39] |= 1;
  CHECK(adjustedCameras(mesh, views, members, offsets)[0].known);
  // All vertices coincide: the pose is undetermined.
  TriangleMesh point;
  point.positions.assign(50, glm::dvec3(0.1));
  const std::vector<CameraSet> all(50, 1);
  const std::vector<glm::vec2> away(50, glm::vec2(1));
  const AdjustedCamera there = adjustedCameras(point, {views.data(), 1}, all, away).front();
  CHECK(std::isfinite(there.afterPx));
  CHECK(std::isfinite(there.camera.pose.position.x + there.camera.intrinsics.fx + there.camera.pose.rotation.w));
  CHECK(there.afterPx < 0.01);
  CHECK(glm::distance(there.camera.pose.position, views[0].camera.pose.position) < 0.1);
  // A wall seen frontally: distance and focal length are indistinguishable, and both must stay bounded.
  const TriangleMesh wall = test::moved(test::flatGrid(8), {-4, -4, 0});
  const HtmView front = plainView(lookingAt({0, 0, 12}, {0, 0, 0}));
  const std::vector<CameraSet> seen(wall.positions.size(), 1);
  std::vector<glm::vec2> larger;
  for (const glm::dvec3& p : wall.positions)
    larger.push_back(glm::vec2(0.01 * (PinholeView(front.camera).seen(p)->pixel - glm::dvec2(60, 45))));
  const AdjustedCamera zoomed = adjustedCameras(wall, {&front, 1}, seen, larger).front();
  CHECK(zoomed.afterPx < 1e-3);
  CHECK(glm::distance(zoomed.camera.pose.position, front.camera.pose.position) < 0.2);
}

}  // namespace ibr
