// SPDX-License-Identifier: Apache-2.0
#include "author/htm/htm_difference.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "htm_object.h"
#include "support/test_meshes.h"

namespace ibr {
namespace {

using test::lookingAt;
using test::plainView;

double sumOf(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

std::vector<double> differencesOf(const TriangleMesh& mesh, const std::vector<HtmView>& views,
                                  std::span<const glm::vec2> complements = {}, int threads = 1) {
  const auto projected = projectedMeshes(mesh, views);
  std::vector<std::uint32_t> all(mesh.triangles.size());
  std::iota(all.begin(), all.end(), 0u);
  return faceDifferences(mesh, projected, faceVisibility(mesh, projected, 1), complements, all, {}, threads);
}

double medianOf(std::vector<double> values) {
  std::ranges::nth_element(values, values.begin() + std::ptrdiff_t(values.size() / 2));
  return values[values.size() / 2];
}

TriangleMesh triangle() {
  return {{{-0.4, -0.3, 0}, {0.4, -0.3, 0}, {0, 0.4, 0}}, {{0, 1, 2}}};
}

}  // namespace

TEST_CASE("scores follow equations 2 and 3 at any angle and exponent") {
  for (const double gamma : {1.0, 10.0, 50.0, 1000.0})
    for (int degrees = 0; degrees <= 180; ++degrees) {
      const double cosine = std::cos(degrees * std::numbers::pi / 180);
      const std::vector<double> facing{cosine, -0.2, cosine, 0.3}, size{10, 0, 70, 20};
      const std::vector<double> scores = cameraScores(facing, size, {0.3, gamma});
      // Weights as logarithms, relative to the largest: powl of a small base underflows as well.
      std::vector<long double> logs;
      for (const double f : facing) logs.push_back(gamma * std::log((static_cast<long double>(f) + 1) / 2));
      const long double most = std::ranges::max(logs);
      long double sum = 0;
      for (const long double l : logs) sum += std::exp(l - most);
      for (std::size_t k = 0; k < facing.size(); ++k) {
        const auto expected = 0.3L * std::exp(logs[k] - most) / sum + 0.7L * static_cast<long double>(size[k]) / 100;
        CHECK(std::isfinite(scores[k]));
        CHECK(scores[k] == Approx(double(expected)).epsilon(1e-9).margin(1e-300));
      }
      CHECK(sumOf(scores) == Approx(1));
    }
}

TEST_CASE("scores sum to one where cameras are indistinguishable") {
  for (const double gamma : {1e-6, 1.0, 1000.0, 1e6})
    for (const double alpha : {0.0, 0.3, 1.0})
      for (const std::size_t n : {1u, 2u, 64u}) {
        const std::vector<double> behind(n, -1.0), none(n, 0.0), front(n, 1.0000001);
        for (const auto& facing : {behind, front, std::vector<double>(n, -0.9999), std::vector<double>(n, -3.0)}) {
          const auto scores = cameraScores(facing, none, {alpha, gamma});
          CHECK(sumOf(scores) == Approx(1));
          for (const double s : scores) CHECK(s == Approx(1 / double(n)));
        }
      }
  CHECK(cameraScores({}, {}, {}).empty());
  const std::vector<double> facing{1, -1}, size{1e-300, 1e300};
  const auto scores = cameraScores(facing, size, {0.3, 1000});
  CHECK(scores[0] == Approx(0.3));
  CHECK(scores[1] == Approx(0.7));
  // A more frontal view never weighs less.
  for (double f = -1; f < 0.99; f += 0.01) {
    const std::vector<double> two{f, f + 0.01}, same{5, 5};
    const auto s = cameraScores(two, same, {0.3, 1000});
    CHECK(s[1] >= s[0]);
  }
}

TEST_CASE("the difference of a face with two colours follows equation 4") {
  const TriangleMesh mesh = triangle();
  // Camera 0 is nearer and more frontal, so it is the best; only camera 1's term is in the sum.
  const std::vector<HtmView> views{plainView(lookingAt({0, 0, 2}, {0, 0, 0}), {100, 50, 10}),
                                   plainView(lookingAt({2, 0, 3}, {0, 0, 0}), {70, 50, 40})};
  std::vector<double> facing, size;
  for (const HtmView& view : views) {
    const PinholeView pinhole(view.camera);
    std::array<glm::dvec2, 3> at;
    for (std::size_t k = 0; k < 3; ++k) at[k] = pinhole.seen(mesh.positions[k])->pixel;
    const glm::dvec2 ab = at[1] - at[0], ac = at[2] - at[0];
    size.push_back(std::abs(ab.x * ac.y - ab.y * ac.x) / 2);
    const glm::dvec3 middle(0, -0.2 / 3, 0), towards = view.camera.pose.position - middle;
    facing.push_back(towards.z / glm::length(towards));
  }
  const double d0 = std::pow((facing[0] + 1) / 2, 10), d1 = std::pow((facing[1] + 1) / 2, 10);
  const double e1 = 0.3 * d1 / (d0 + d1) + 0.7 * size[1] / (size[0] + size[1]);
  CHECK(e1 < 0.5);
  CHECK(differencesOf(mesh, views)[0] == Approx(e1 * (30 + 0 + 30) / 3.0));
  CHECK(differencesOf(mesh, {views[1], views[0]})[0] == Approx(e1 * 20));
  // A camera that does not see the face changes nothing; a camera that agrees with the best halves the mean.
  auto more = views;
  more.push_back(plainView(lookingAt({0, 0, 2}, {0, 0, 4})));
  CHECK(differencesOf(mesh, more)[0] == Approx(e1 * 20));
  // With one camera or none there is no difference.
  CHECK(differencesOf(mesh, {views[0]})[0] == 0);
  CHECK(differencesOf(mesh, {more[2]})[0] == 0);
}

TEST_CASE("cameras that share no pixel of a face have no difference there") {
  std::vector<HtmView> views{plainView(lookingAt({0, 0, 2}, {0, 0, 0}), {0, 0, 0}),
                             plainView(lookingAt({0.1, 0, 2}, {0, 0, 0}), {255, 255, 255})};
  CHECK(differencesOf(triangle(), views)[0] > 100);
  for (std::size_t i = 0; i < 2; ++i) {
    views[i].mask = Image8(120, 90, 1);
    for (int y = 0; y < 90; ++y)
      for (int x = i == 0 ? 0 : 62; x < (i == 0 ? 56 : 120); ++x) views[i].mask.pixel(x, y)[0] = 255;
  }
  CHECK(differencesOf(triangle(), views)[0] == 0);
}

TEST_CASE("a face with a corner just in front of a camera is compared as densely as any other") {
  const std::vector<HtmView> plain{plainView(test::aboveGround()),
                                   plainView(lookingAt({0.3, 0.5, 3}, {0, -1.5, -6}, 240, 180))};
  std::vector<HtmView> views = plain;
  const PinholeView pinhole(views[1].camera);
  for (int y = 0; y < 180; ++y)
    for (int x = 0; x < 240; ++x) {
      const glm::dvec3 from = pinhole.centre(), along = pinhole.point({x + 0.5, y + 0.5}, 1) - from;
      const glm::dvec3 at = from - along * ((from.y + 1.5) / along.y);
      if (along.y < 0 && glm::distance(at, glm::dvec3(0.6, -1.5, -5.5)) < 0.6) views[1].picture.pixel(x, y)[1] = 200;
    }
  const double usual = differencesOf(test::groundUpTo(1e-3), views)[0];
  CHECK(usual > 0.01);
  for (const double before : test::kBarelyBefore) {
    INFO(before);
    CHECK(differencesOf(test::groundUpTo(before), views)[0] == Approx(usual).epsilon(0.05));
    CHECK(differencesOf(test::groundUpTo(before), {views[1], views[0]})[0] == Approx(usual).epsilon(0.05));
    CHECK(differencesOf(test::groundUpTo(before), plain)[0] == 0);
  }
}

TEST_CASE("exact images differ by their sampling only, and complements compensate camera errors") {
  const auto meanOf = [](const std::vector<double>& d) { return sumOf(d) / double(d.size()); };
  test::BumpyOptions options;
  options.disagreement = 0;
  double expected = 0;
  for (const glm::dvec3& middle : {glm::dvec3(0), glm::dvec3(1e6, -1e6, 3e5)}) {
    options.middle = middle;
    const test::BumpyModel exact = test::bumpyModel(options);
    const TriangleMesh& mesh = exact.model.surface.mesh;
    std::vector<HtmView> views = test::viewsOf(exact);
    const auto none = differencesOf(mesh, views);
    CHECK(meanOf(none) < 1.5);
    std::vector<Camera> truly, given;
    for (std::size_t i = 0; i < views.size(); ++i) {
      truly.push_back(views[i].camera);
      given.push_back(test::disturbed(views[i].camera, 0.008, 0.01, int(i)));
      views[i].camera = given.back();
    }
    std::vector<glm::vec2> complements = test::trueComplements(mesh, truly, given);
    for (glm::vec2& c : complements)
      if (std::isnan(c.x)) c = {};
    const auto without = differencesOf(mesh, views), with = differencesOf(mesh, views, complements);
    CHECK(meanOf(without) > 4 * meanOf(none));
    // Median, because vertices across folds have no complement.
    CHECK(medianOf(with) < 0.4 * medianOf(without));
    CHECK(medianOf(without) > 4 * medianOf(none));
    CHECK(differencesOf(mesh, views, complements, 2) == with);
    for (const double d : without) CHECK((d >= 0 && d <= 255));
    const std::vector<glm::vec2> zero(complements.size(), glm::vec2(0));
    CHECK(differencesOf(mesh, views, zero) == without);
    // The difference does not depend on the position in the world.
    if (expected > 0) CHECK(meanOf(without) == Approx(expected).epsilon(0.01));
    expected = meanOf(without);
  }
}

}  // namespace ibr
