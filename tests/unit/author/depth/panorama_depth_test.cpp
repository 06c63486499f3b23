// SPDX-License-Identifier: Apache-2.0
#include "author/depth/panorama_depth.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <numbers>
#include <vector>

#include "author/backdrop/complete_depth.h"
#include "ibr/author/panorama.h"
#include "support/error_of.h"

using namespace ibr;

namespace {

const glm::dquat kTurned = glm::normalize(glm::dquat(0.8, 0.1, -0.5, 0.3));

Camera panorama(int width) {
  return {{CameraModel::equirectangular, width, width / 2}, {{3, -1, 2}, kTurned}};
}

// Returns the faces' depth of surroundings at distance(direction); unit directions in the panorama's axes.
template <class Distance>
std::vector<MatchedDepth> facesOf(const Camera& camera, const Distance& distance) {
  std::vector<MatchedDepth> faces;
  for (const Camera& face : depthFaces(camera)) {
    const Intrinsics& k = face.intrinsics;
    const glm::dquat toPanorama = glm::conjugate(camera.pose.rotation) * face.pose.rotation;
    ImageF depth(k.width, k.height, 1);
    for (int y = 0; y < k.height; ++y)
      for (int x = 0; x < k.width; ++x) {
        const glm::dvec3 ray = unproject(k, {x + 0.5, y + 0.5});
        depth.pixel(x, y)[0] = float(1 / (distance(toPanorama * ray) * -ray.z));
      }
    const Image8 none(k.width, k.height, 1, 0);
    faces.push_back({{{face, std::move(depth)}, 0.01, 0.5}, {}, {none, none, none}});
  }
  return faces;
}

}  // namespace

TEST_CASE("the faces of a panorama have its position and resolution") {
  const Camera camera = panorama(360);
  const std::vector<Camera> faces = depthFaces(camera);
  REQUIRE(faces.size() == 6);
  const std::vector<PanoramaFace> cube = cubeFaces();
  for (std::size_t f = 0; f < 6; ++f) {
    CHECK(faces[f].pose.position == camera.pose.position);
    CHECK(std::abs(glm::dot(faces[f].pose.rotation, kTurned * cube[f].rotation)) == Approx(1));
    CHECK(faces[f].intrinsics.fx == Approx(360 / (2 * std::numbers::pi)).epsilon(0.02));
    // A face is wider than a quarter of the view, so windows and surfaces continue beyond the face's edges.
    CHECK(faces[f].intrinsics.width > 2 * faces[f].intrinsics.fx);
  }
  CHECK(depthFaces(panorama(2)).front().intrinsics.width >= 1);
}

TEST_CASE("a sphere around the panorama has equal depth in all pixels") {
  for (const int width : {8, 64, 360}) {
    CAPTURE(width);
    const Camera camera = panorama(width);
    const MatchedDepth whole = onSphere(camera, facesOf(camera, [](glm::dvec3) { return 5.0; }));
    CHECK(whole.matched.map.camera.intrinsics.width == width);
    CHECK(whole.matched.map.inverseDepth.height == width / 2);
    CHECK(whole.matched.step == 0.01);
    CHECK(whole.matched.residualPx == 0.5);
    CHECK(whole.sky.empty());
    // Resampling shifts a pixel by up to half its width on the face, at most 48° off the axis.
    for (const float w : whole.matched.map.inverseDepth.values) REQUIRE(w == Approx(0.2).epsilon(4.0 / width));
  }
}

TEST_CASE("a panorama's pixel has the inverse distance along its ray") {
  const Camera camera = panorama(512);
  // Room in the panorama's axes: walls at x = ±2, floor and ceiling at y = ±3, ends at z = ±4.
  const auto room = [](glm::dvec3 d) {
    const glm::dvec3 a = glm::abs(d);
    return 1 / std::max({a.x / 2, a.y / 3, a.z / 4});
  };
  const MatchedDepth whole = onSphere(camera, facesOf(camera, room));
  const Intrinsics& k = camera.intrinsics;
  for (int y = 0; y < k.height; ++y)
    for (int x = 0; x < k.width; ++x) {
      CAPTURE(x, y);
      REQUIRE(whole.matched.map.inverseDepth.pixel(x, y)[0] ==
              Approx(1 / room(unproject(k, {x + 0.5, y + 0.5}))).epsilon(0.03));
    }
}

TEST_CASE("evidence and unknown depth come from the face in a pixel's direction") {
  const Camera camera = panorama(128);
  std::vector<MatchedDepth> faces = facesOf(camera, [](glm::dvec3) { return 5.0; });
  for (std::size_t f = 0; f < 6; ++f) {
    std::ranges::fill(faces[f].evidence.confirmations.values, std::uint8_t(f + 1));
    std::ranges::fill(faces[f].evidence.contradictions.values, std::uint8_t(f + 11));
    std::ranges::fill(faces[f].evidence.usableSources.values, std::uint8_t(f + 21));
  }
  std::ranges::fill(faces[2].matched.map.inverseDepth.values, kUnknownDepth);  // face 2 looks back
  std::ranges::fill(faces[5].matched.map.inverseDepth.values, 0.0f);           // down: infinity is known
  const MatchedDepth whole = onSphere(camera, faces);
  struct Case {
    int x, y, face;
  };
  // The front face is in the middle columns, the back face at both ends; up and down fill the rows at the poles.
  for (const Case& each :
       {Case{64, 32, 0}, {96, 32, 1}, {0, 32, 2}, {127, 32, 2}, {32, 32, 3}, {5, 0, 4}, {90, 63, 5}}) {
    CAPTURE(each.x, each.y);
    CHECK(int(whole.evidence.confirmations.pixel(each.x, each.y)[0]) == each.face + 1);
    CHECK(int(whole.evidence.contradictions.pixel(each.x, each.y)[0]) == each.face + 11);
    CHECK(int(whole.evidence.usableSources.pixel(each.x, each.y)[0]) == each.face + 21);
    const float w = whole.matched.map.inverseDepth.pixel(each.x, each.y)[0];
    if (each.face == 2)
      CHECK(w == kUnknownDepth);
    else
      CHECK(w == Approx(each.face == 5 ? 0 : 0.2).epsilon(0.05));
  }
  faces.pop_back();
  CHECK(test::errorOf([&] { onSphere(camera, faces); }).code() == ErrorCode::invalidInput);
}

TEST_CASE("faces may have different sizes, with or without sky") {
  const Camera camera = panorama(128);
  std::vector<MatchedDepth> faces = facesOf(camera, [](glm::dvec3) { return 5.0; });
  const std::vector<MatchedDepth> finer = facesOf(panorama(256), [](glm::dvec3) { return 5.0; });
  faces[1] = finer[1];
  const Image8& depth = faces[4].evidence.usableSources;  // face 4 looks up
  faces[4].sky = Image8(depth.width, depth.height, 1, 255);
  const MatchedDepth whole = onSphere(camera, faces);
  for (const float w : whole.matched.map.inverseDepth.values) REQUIRE(w == Approx(0.2).epsilon(0.04));
  REQUIRE(whole.sky.width == 128);
  CHECK(int(whole.sky.pixel(10, 0)[0]) == 255);
  CHECK(int(whole.sky.pixel(64, 32)[0]) == 0);
  CHECK(int(whole.sky.pixel(10, 63)[0]) == 0);
}
