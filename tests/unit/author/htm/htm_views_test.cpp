// SPDX-License-Identifier: Apache-2.0
#include "author/htm/htm_views.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "author/htm/htm_visibility.h"
#include "htm_object.h"
#include "support/test_meshes.h"

namespace ibr {
namespace {

using test::lookingAt;
using test::plainView;

const glm::dvec3 kFarAway(1e6, -2e6, 5e5);

// A square of side `size` at `middle`, perpendicular to z, facing +z.
TriangleMesh board(glm::dvec3 middle, double size) {
  TriangleMesh mesh;
  for (const glm::dvec2 corner : {glm::dvec2(-1, -1), {1, -1}, {1, 1}, {-1, 1}})
    mesh.positions.push_back(middle + 0.5 * size * glm::dvec3(corner, 0));
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}
TriangleMesh joined(TriangleMesh a, const TriangleMesh& b) {
  const auto first = glm::uint(a.positions.size());
  a.positions.insert(a.positions.end(), b.positions.begin(), b.positions.end());
  for (const glm::uvec3& t : b.triangles) a.triangles.push_back(t + first);
  return a;
}

ProjectedMesh projected(const TriangleMesh& mesh, const HtmView& view) {
  return projectedMeshes(mesh, {&view, 1}).front();
}

std::vector<std::size_t> facesSeenBy(const TriangleMesh& mesh, const std::vector<HtmView>& views, std::size_t camera) {
  const auto faces = faceVisibility(mesh, projectedMeshes(mesh, views), 1);
  std::vector<std::size_t> seen;
  for (std::size_t f = 0; f < faces.size(); ++f)
    if (faces[f].seen >> camera & 1) seen.push_back(f);
  return seen;
}

}  // namespace

TEST_CASE("a pinhole view projects like the camera model, and unprojects to the same points") {
  const Camera camera = lookingAt({1, 2, 3}, {0.2, -0.1, 0.3}, 200, 140, 0.9);
  const PinholeView view(camera);
  for (const glm::dvec3& point : {glm::dvec3(0), {0.4, 0.2, -0.5}, {-2, 1, 0}}) {
    const auto seen = view.seen(point);
    const auto expected =
        project(camera.intrinsics, glm::conjugate(camera.pose.rotation) * (point - camera.pose.position));
    REQUIRE(seen);
    CHECK(glm::distance(seen->pixel, *expected) < 1e-9);
    CHECK(glm::distance(view.point(seen->pixel, seen->depth), point) < 1e-12);
    CHECK(seen->depth == Approx(glm::dot(point - camera.pose.position, viewAxis(camera.pose))));
  }
  CHECK(!view.seen({2, 4, 6}));
  CHECK(!view.seen({1, 2, 3}));
  CHECK(!view.seen(glm::dvec3(std::nan(""))));
  CHECK(view.inside({0.5, 0.5}));
  CHECK(view.inside({199.5, 139.5}));
  CHECK(!view.inside({0.49, 10}));
  CHECK(!view.inside({10, 139.51}));
  CHECK(!view.inside(glm::dvec2(std::nan(""))));
}

TEST_CASE("the nearest surface is rasterised, with its depth") {
  for (const glm::dvec3& offset : {glm::dvec3(0), kFarAway}) {
    const TriangleMesh mesh = joined(board(offset + glm::dvec3(0, 0, -1), 4), board(offset, 0.5));
    const Camera camera = lookingAt(offset + glm::dvec3(0, 0, 2), offset);
    const MeshRaster raster = rasterised(mesh, camera);
    CHECK(raster.face.pixel(60, 45)[0] >= 2);
    CHECK(raster.depth.pixel(60, 45)[0] == Approx(2).epsilon(1e-6));
    CHECK(raster.face.pixel(4, 4)[0] < 2);
    CHECK(raster.depth.pixel(4, 4)[0] == Approx(3).epsilon(1e-6));
    const MeshRaster empty = rasterised(mesh, lookingAt(offset + glm::dvec3(0, 0, 2), offset + glm::dvec3(0, 0, 4)));
    CHECK(std::ranges::all_of(empty.face.values, [](std::uint32_t f) { return f == MeshRaster::kNone; }));
    CHECK(std::ranges::all_of(empty.depth.values, [](float d) { return std::isinf(d); }));
  }
  // A face with a corner behind the camera is left out, as is a degenerate face.
  TriangleMesh through = board({0, 0, 0}, 1);
  through.positions[0].z = 10;
  const MeshRaster raster = rasterised(through, lookingAt({0, 0, 2}, {0, 0, 0}));
  CHECK(std::ranges::all_of(raster.face.values, [](std::uint32_t f) { return f == MeshRaster::kNone; }));
  TriangleMesh thin = board({0, 0, 0}, 1);
  thin.triangles = {{0, 0, 1}, {2, 2, 2}};
  CHECK(std::ranges::all_of(rasterised(thin, lookingAt({0, 0, 2}, {0, 0, 0})).face.values,
                            [](std::uint32_t f) { return f == MeshRaster::kNone; }));
}

TEST_CASE("a point is visible unless it is hidden, masked, outside the image or behind the camera") {
  for (const glm::dvec3& offset : {glm::dvec3(0), kFarAway}) {
    const TriangleMesh mesh = joined(board(offset + glm::dvec3(0, 0, -1), 4), board(offset, 0.5));
    HtmView view = plainView(lookingAt(offset + glm::dvec3(0, 0, 2), offset));
    const auto sees = [&](glm::dvec3 point) { return projected(mesh, view).visible(offset + point).has_value(); };
    CHECK(sees({0, 0, 0}));
    CHECK(sees({0.2, -0.2, 0}));
    CHECK(sees({0, 0, 1}));    // in front of the boards
    CHECK(!sees({0, 0, -1}));  // behind the small board
    CHECK(!sees({0.3, 0.3, -1}));
    CHECK(sees({0.6, 0.6, -1}));
    CHECK(!sees({0, 0, 3}));   // behind the camera
    CHECK(!sees({5, 0, -1}));  // outside the picture
    CHECK(!sees({0, 0, -0.02}));
    CHECK(projected(mesh, view).visible(offset)->x == Approx(60).margin(1e-6));
    CHECK(projected(board(offset, 0.5), view).visible(offset + glm::dvec3(0.5, 0.5, 0)));  // beside the mesh
    view.mask = Image8(view.camera.intrinsics.width, view.camera.intrinsics.height, 1);
    for (int y = 0; y < view.mask.height; ++y)
      for (int x = 0; x < 60; ++x) view.mask.pixel(x, y)[0] = 128;
    for (int y = 0; y < view.mask.height; ++y)
      for (int x = 60; x < view.mask.width; ++x) view.mask.pixel(x, y)[0] = 127;
    CHECK(sees({-0.1, 0, 0}));
    CHECK(!sees({0.1, 0, 0}));
  }
}

TEST_CASE("each camera sees the front faces of a cube, and vertices are visible with their faces") {
  for (const glm::dvec3& offset : {glm::dvec3(0), kFarAway}) {
    const TriangleMesh mesh = test::cube(offset);
    const glm::dvec3 middle = offset + 0.5;
    const std::vector<HtmView> views{plainView(lookingAt(middle + glm::dvec3(0, 0, 3), middle)),
                                     plainView(lookingAt(middle + glm::dvec3(3, 0, 3), middle)),
                                     plainView(lookingAt(middle + glm::dvec3(0, 0, 3), middle + glm::dvec3(0, 0, 6))),
                                     plainView(lookingAt(middle + glm::dvec3(2, 2, 2), middle))};
    CHECK(facesSeenBy(mesh, views, 0) == std::vector<std::size_t>{2, 3});
    CHECK(facesSeenBy(mesh, views, 1) == std::vector<std::size_t>{2, 3, 10, 11});
    CHECK(facesSeenBy(mesh, views, 2).empty());
    CHECK(facesSeenBy(mesh, views, 3) == std::vector<std::size_t>{2, 3, 6, 7, 10, 11});
    const auto faces = faceVisibility(mesh, projectedMeshes(mesh, views), 1);
    CHECK(std::ranges::all_of(faces, [](const FaceVisibility& f) { return f.partly == 0; }));
    const auto members = vertexVisibility(mesh, faces);
    for (std::size_t v = 0; v < 8; ++v) CHECK((members[v] & 1) == (v >> 2));  // vertices of the board at z = 1
    CHECK((members[0] & 8) == 0);
    CHECK((members[7] & 8) == 8);
  }
}

TEST_CASE("a partly hidden face is seen and marked as partly hidden, a fully hidden face is not seen") {
  const auto visibilityOf = [](double frontSize, glm::dvec3 front) {
    const TriangleMesh mesh = joined(board({0, 0, -1}, 1), board(front, frontSize));
    const HtmView view = plainView(lookingAt({0, 0, 2}, {0, 0, 0}));
    return faceVisibility(mesh, projectedMeshes(mesh, {&view, 1}), 1);
  };
  auto faces = visibilityOf(0.2, {0, 0, 0});
  CHECK((faces[0].seen && faces[0].partly && faces[2].seen && !faces[2].partly));
  faces = visibilityOf(3, {0, 0, 0});
  CHECK((!faces[0].seen && !faces[0].partly && faces[3].seen));
  faces = visibilityOf(0.2, {0.9, 0, 0});
  CHECK((faces[0].seen && !faces[0].partly));
}

TEST_CASE("a face is seen only if a quarter of it is inside the image and the mask") {
  const TriangleMesh mesh = board({0, 0, 0}, 1);
  const auto seen = [&](HtmView view) {
    return faceVisibility(mesh, projectedMeshes(mesh, {&view, 1}), 1)[0].seen == 1;
  };
  CHECK(seen(plainView(lookingAt({0, 0, 2}, {0, 0, 0}))));
  CHECK(!seen(plainView(lookingAt({0, 0, 2}, {2, 0, 0}))));
  CHECK(!seen(plainView(lookingAt({0, 0, -2}, {0, 0, 0}))));  // seen from behind
  HtmView view = plainView(lookingAt({0, 0, 2}, {0, 0, 0}));
  view.mask = Image8(view.camera.intrinsics.width, view.camera.intrinsics.height, 1);
  CHECK(!seen(view));
  view.mask = Image8(view.camera.intrinsics.width, view.camera.intrinsics.height, 1, 255);
  CHECK(seen(view));
  CHECK(faceVisibility({}, projectedMeshes({}, {&view, 1}), 1).empty());
}

TEST_CASE("halved views see the same surfaces at half the resolution") {
  for (const int width : {120, 121}) {
    const TriangleMesh mesh = joined(board({0, 0, -1}, 4), board({0, 0, 0}, 0.5));
    HtmView view = plainView(lookingAt({0, 0, 2}, {0, 0, 0}, width, 90), {10, 20, 30});
    view.mask = Image8(width, 90, 1, 255);
    const ProjectedMesh half = projectedMeshes(mesh, {&view, 1}, 1).front();
    CHECK(half.picture->width == width / 2);
    CHECK(half.mask->height == 45);
    CHECK(half.picture->pixel(3, 3)[2] == 30);
    for (const glm::dvec3 point : {glm::dvec3(0.1, 0.2, 0), {0.9, 0.8, -1}}) {
      const auto there = half.visible(point);
      REQUIRE(there);
      const glm::dvec2 full = PinholeView(view.camera).seen(point)->pixel;
      CHECK(glm::distance(*there, full * glm::dvec2(half.picture->width / double(width), 0.5)) < 1e-9);
    }
    CHECK(!half.visible({0.1, 0.1, -1}));
  }
}

TEST_CASE("far outside the image nothing hides a point, and the mask's border continues") {
  const TriangleMesh mesh = board({0, 0, 0}, 10);
  HtmView view = plainView(lookingAt({0, 0, 2}, {0, 0, 0}));
  view.mask = Image8(120, 90, 1);
  for (int y = 0; y < 90; ++y)
    for (int x = 0; x < 60; ++x) view.mask.pixel(x, y)[0] = 255;
  const ProjectedMesh there = projected(mesh, view);
  CHECK(!there.raster.shows({60, 45}, 100));
  for (const glm::dvec2 rim : {glm::dvec2(-0.4, -0.4), {120.4, 90.4}}) CHECK(!there.raster.shows(rim, 100));
  for (const double far : {122.0, 1e9, 1e10, 1e300, HUGE_VAL})
    for (const double sign : {-1.0, 1.0}) {
      INFO(sign * far);
      CHECK(there.raster.shows({sign * far, 45}, 100));
      CHECK(there.raster.shows({60, sign * far}, 100));
      CHECK(there.raster.shows({sign * far, -sign * far}, 100));
      CHECK(there.masked({sign * far, 45}) == (sign < 0));
      CHECK(there.masked({20, sign * far}));
      CHECK(!there.masked({80, sign * far}));
    }
  CHECK(there.raster.shows(glm::dvec2(std::nan("")), 100));
}

TEST_CASE("a face with a corner just in front of the camera is sampled as densely as any other") {
  const HtmView view = plainView(test::aboveGround());
  const TriangleMesh leaf = board({0.341, -0.82, -3}, 0.2);  // hides a small part of the ground
  for (const double before : test::kBarelyBefore) {
    INFO(before);
    const TriangleMesh ground = test::groundUpTo(before), both = joined(ground, leaf);
    const auto alone = faceVisibility(ground, projectedMeshes(ground, {&view, 1}), 1)[0];
    CHECK((alone.seen == 1 && alone.partly == 0));
    const auto covered = faceVisibility(both, projectedMeshes(both, {&view, 1}), 1)[0];
    CHECK((covered.seen == 1 && covered.partly == 1));
  }
}

TEST_CASE("views share their images at full size, and do not depend on the thread count") {
  const TriangleMesh mesh = joined(board({0, 0, -1}, 4), board({0, 0, 0}, 0.5));
  std::vector<HtmView> views;
  for (const double x : {-1.0, 0.0, 0.5, 2.0}) views.push_back(plainView(lookingAt({x, 0, 2}, {0, 0, 0})));
  views[1].mask = Image8(120, 90, 1, 255);
  for (const int halvings : {0, 1}) {
    const auto alone = projectedMeshes(mesh, views, halvings, 1), together = projectedMeshes(mesh, views, halvings, 3);
    REQUIRE((alone.size() == views.size() && together.size() == views.size()));
    for (std::size_t i = 0; i < views.size(); ++i) {
      CHECK(alone[i].raster.face == together[i].raster.face);
      CHECK(alone[i].raster.depth == together[i].raster.depth);
      CHECK((alone[i].picture.get() == &views[i].picture) == (halvings == 0));
      CHECK((alone[i].mask.get() == &views[i].mask) == (halvings == 0 || views[i].mask.empty()));
      const ProjectedMesh copy = together[i];
      CHECK((copy.picture == together[i].picture && copy.mask == together[i].mask));
      CHECK(*copy.picture == *alone[i].picture);
    }
  }
  CHECK(projectedMeshes(mesh, std::span<const HtmView>(), 0, 0).empty());
}

TEST_CASE("visibility falls towards the background and at depth discontinuities") {
  const HtmView view = plainView(lookingAt({0, 0, 2}, {0, 0, 0}));
  SECTION("a surface that fills the image is fully visible") {
    const Image8 soft = softVisibility(projected(board({0, 0, 0}, 10), view), 4);
    CHECK(std::ranges::all_of(soft.values, [](int v) { return v == 255; }));
  }
  SECTION("nothing is visible without a surface") {
    const Image8 soft = softVisibility(projected({}, view), 4);
    CHECK(std::ranges::all_of(soft.values, [](int v) { return v == 0; }));
  }
  SECTION("visibility falls towards a silhouette") {
    const ProjectedMesh there = projected(board({0, 0, 0}, 0.5), view);
    const Image8 soft = softVisibility(there, 4);
    for (int y = 0; y < 90; ++y)
      for (int x = 0; x < 120; ++x)
        CHECK((soft.pixel(x, y)[0] > 0) == (there.raster.face.pixel(x, y)[0] != MeshRaster::kNone));
    int edge = 60;
    while (soft.pixel(edge, 45)[0] > 0) ++edge;
    CHECK(soft.pixel(edge - 1, 45)[0] == 64);
    CHECK(soft.pixel(edge - 2, 45)[0] == 128);
    CHECK(soft.pixel(edge - 4, 45)[0] == 255);
  }
  SECTION("visibility falls at a depth step, but not on a slanted plane") {
    const Image8 soft = softVisibility(projected(joined(board({0, 0, -1}, 9), board({0, 0, 0}, 0.5)), view), 4);
    int least = 255;
    for (int x = 60; x < 120; ++x) least = std::min<int>(least, soft.pixel(x, 45)[0]);
    CHECK(least == 1);
    CHECK(soft.pixel(60, 45)[0] == 255);
    CHECK(soft.pixel(118, 45)[0] == 255);
    const HtmView slanted = plainView(lookingAt({3, 0, 1}, {0, 0, 0}));
    const Image8 plane = softVisibility(projected(board({0, 0, 0}, 1), slanted), 4);
    CHECK(plane.pixel(60, 45)[0] == 255);
  }
  SECTION("visibility ends at the mask") {
    HtmView masked = view;
    masked.mask = Image8(120, 90, 1);
    for (int y = 30; y < 60; ++y)
      for (int x = 30; x < 90; ++x) masked.mask.pixel(x, y)[0] = 128;
    const Image8 soft = softVisibility(projected(board({0, 0, 0}, 10), masked), 4);
    for (int y = 0; y < 90; ++y)
      for (int x = 0; x < 120; ++x) CHECK((soft.pixel(x, y)[0] > 0) == (x >= 30 && x < 90 && y >= 30 && y < 60));
    CHECK(soft.pixel(60, 45)[0] == 255);
  }
}

}  // namespace ibr
