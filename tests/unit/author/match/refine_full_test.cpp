// SPDX-License-Identifier: Apache-2.0
#include "author/match/refine_full.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "author/geometry/posed_model.h"
#include "author/match/vertices.h"
#include "ibr/author/photographs.h"
#include "lab/generate/synthetic.h"

using namespace ibr;

namespace {

constexpr int kScale = 2;  // size of whole photographs relative to matched ones

struct Set {
  SyntheticScene scene;
  std::vector<Camera> whole;
  std::vector<MatchView> views;
  std::vector<Image8> grey;
};

// A slanted wall whose texture is as fine as the whole photographs' pixels.
Set wall(double wavelength = 0.12) {
  SyntheticOptions options;
  options.planes = {{{0, 0, -6}, glm::normalize(glm::dvec3(1, 0, 0.3)), {0, 1, 0}, 30, 20, 1, wavelength}};
  for (const glm::dvec3 place : {glm::dvec3(0, 0, 0), {0.5, 0, 0}, {0.25, 0.4, 0}})
    options.cameras.push_back({pinholeFromFov(240 * kScale, 180 * kScale, 0.9), {place, {1, 0, 0, 0}}});
  options.samplesPerAxis = 2;
  Set set{makeScene(options), options.cameras, {}, {}};
  for (std::size_t i = 0; i < set.whole.size(); ++i) {
    const Image8& picture = set.scene.photographs[i];
    set.views.push_back(
        {{resized(set.whole[i].intrinsics, 240, 180), set.whole[i].pose}, downscaled(picture, 240, 180)});
    Image8& grey = set.grey.emplace_back(picture.width, picture.height, 1);
    for (std::size_t p = 0; p < grey.values.size(); ++p) grey.values[p] = picture.values[3 * p + 1];
  }
  return set;
}

std::vector<glm::dvec3> somePoints() {
  std::vector<glm::dvec3> points;
  for (int i = 0; i < 40; ++i) points.emplace_back(-2 + 0.1 * i, 0.1 * (i % 7), -6 + 0.3 * (-2 + 0.1 * i));
  return points;
}

// Median distance from the exact match, px of the whole photograph.
double error(const Set& set, const MatchedVertices& vertices) {
  const TexturedPlane& plane = set.scene.planes[0];
  const glm::dvec3 normal = glm::cross(plane.u, plane.v);
  std::vector<double> errors;
  for (std::size_t v = 0; v < vertices.frame.size(); ++v) {
    const auto& [k, pose] = set.whole[0];
    const glm::dvec3 ray = unproject(k, glm::dvec2(vertices.matched[0][v]) * double(kScale));
    const glm::dvec3 point =
        pose.position + ray * (glm::dot(plane.origin - pose.position, normal) / glm::dot(ray, normal));
    for (std::size_t i = 1; i < set.whole.size(); ++i) {
      const auto at = project(set.whole[i].intrinsics, point - set.whole[i].pose.position);
      errors.push_back(glm::distance(*at, glm::dvec2(vertices.matched[i][v]) * double(kScale)));
    }
  }
  return median(errors);
}

}  // namespace

TEST_CASE("matches of downsampled images are refined to the accuracy of full-size photographs") {
  static const Set set = wall();
  const bool exactPoses = GENERATE(true, false);
  const DenseMatch match = matchViews(set.views, somePoints(), {!exactPoses});
  MatchedVertices vertices = matchedVertices(set.views, match);
  REQUIRE(vertices.frame.size() > 200);

  // Tests the matches as found, and shifted by up to half a pixel of the matched size.
  std::mt19937 random(1);
  const auto push = [&] { return float(random()) / 4294967295.0F - 0.5F; };
  for (const bool pushed : {false, true}) {
    if (pushed && exactPoses) continue;  // exact poses keep matches on epipolar lines; shifted ones lie beside
    MatchedVertices moved = vertices;
    if (pushed)
      for (std::size_t i = 1; i < moved.matched.size(); ++i)
        for (glm::vec2& at : moved.matched[i]) at += glm::vec2(push(), push());
    const double before = error(set, moved);
    refineAtFullSize(set.views, set.grey, match, moved);
    const double after = error(set, moved);
    INFO("exact poses " << exactPoses << ", pushed " << pushed << ": " << before << " -> " << after << " px");
    CHECK(after < 0.12);
    if (pushed) CHECK(after < 0.25 * before);
    CHECK(moved.matched[0] == vertices.matched[0]);
    MatchedVertices again = moved;
    refineAtFullSize(set.views, set.grey, match, again);
    CHECK(std::abs(error(set, again) - after) < 0.02);
  }
}

TEST_CASE("matches stay where full-size photographs have no texture") {
  static const Set set = wall();
  const DenseMatch match = matchViews(set.views, somePoints(), {true});
  const MatchedVertices vertices = matchedVertices(set.views, match);
  std::vector<Image8> flat = set.grey;
  for (Image8& picture : flat) std::fill(picture.values.begin(), picture.values.end(), std::uint8_t(120));
  MatchedVertices same = vertices;
  refineAtFullSize(set.views, flat, match, same);
  CHECK(same.matched == vertices.matched);

  // At a picture's edge a patch is incomplete.
  MatchedVertices edge = vertices;
  for (auto& list : edge.matched) list.assign(list.size(), glm::vec2(0.5F, 0.5F));
  const MatchedVertices before = edge;
  refineAtFullSize(set.views, set.grey, match, edge);
  CHECK(edge.matched == before.matched);

  // The result does not depend on contrast and brightness.
  std::vector<Image8> darker = set.grey;
  for (auto& v : darker[1].values) v = std::uint8_t(20 + v / 2);
  MatchedVertices found = vertices, foundDarker = vertices;
  refineAtFullSize(set.views, set.grey, match, found);
  refineAtFullSize(set.views, darker, match, foundDarker);
  CHECK(error(set, foundDarker) < error(set, found) + 0.05);
}
