// SPDX-License-Identifier: Apache-2.0
#include "author/htm/htm_match.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <mutex>
#include <numbers>
#include <random>

#include "htm_object.h"
#include "support/error_of.h"
#include "support/test_meshes.h"

namespace ibr {
namespace {

using enum TemplateMeasure;

// Samples a function of position at pixel centres as grey levels.
template <class F>
Image8 pictureOf(int width, int height, F&& level) {
  Image8 picture(width, height, 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (std::size_t c = 0; c < 3; ++c)
        picture.pixel(x, y)[c] = std::uint8_t(std::clamp(std::lround(level(x + 0.5, y + 0.5)), 0l, 255l));
  return picture;
}
template <class F>
std::vector<TemplateSample> samplesOf(glm::ivec2 corner, int side, glm::dvec2 shift, F&& level) {
  std::vector<TemplateSample> samples;
  for (int y = corner.y; y < corner.y + side; ++y)
    for (int x = corner.x; x < corner.x + side; ++x) {
      const auto value = std::uint8_t(std::clamp(std::lround(level(x + 0.5 + shift.x, y + 0.5 + shift.y)), 0l, 255l));
      samples.push_back({std::int16_t(x), std::int16_t(y), value, value, value});
    }
  return samples;
}

double waves(double x, double y) {
  return 120 + 40 * std::sin(0.55 * x + 0.2 * y) + 40 * std::sin(0.5 * y - 0.3 * x + 1);
}

bool finite(const VertexMatch& m) {
  return std::isfinite(m.displacement.x) && std::isfinite(m.displacement.y) && std::isfinite(m.information.x) &&
         std::isfinite(m.information.y) && std::isfinite(m.information.z);
}
bool semidefinite(const VertexMatch& m) {
  return m.information.x >= 0 && m.information.z >= 0 &&
         m.information.x * m.information.z - m.information.y * m.information.y >=
             -1e-3f * m.information.x * m.information.z;
}

// A plane, seen by two cameras side by side; the second camera's given pose has a rotation error.
struct Wall {
  TriangleMesh mesh = test::moved(test::flatGrid(6), {-3, -3, 0});
  std::vector<Camera> truly, given;
  std::vector<HtmView> views;
  std::vector<CameraSet> members;
  template <class F>
  explicit Wall(F&& level, double turn = 0.01) {
    for (const double x : {-0.6, 0.7}) truly.push_back(test::lookingAt({x, 0.2, 6}, {0, 0, 0}, 160, 120));
    given = {truly[0], test::disturbed(truly[1], turn, 0.0, 3)};
    for (std::size_t i = 0; i < 2; ++i) {
      const PinholeView view(truly[i]);
      views.push_back(
          {given[i],
           pictureOf(160, 120,
                     [&](double x, double y) {
                       const glm::dvec3 far = view.point({x, y}, 1), from = view.centre(), along = far - from;
                       const glm::dvec3 at = from - along * (from.z / along.z);
                       return level(at.x, at.y);
                     }),
           {}});
    }
    members.assign(mesh.positions.size(), 3);
  }
  std::vector<VertexMatch> matched(TemplateMeasure measure, std::span<const glm::vec2> start = {},
                                   int threads = 1) const {
    VertexMatchOptions options;
    options.measure = measure;
    options.threads = threads;
    return matched(options, start);
  }
  std::vector<VertexMatch> matched(const VertexMatchOptions& options, std::span<const glm::vec2> start,
                                   const ProgressCallback& progress = {}) const {
    return matchVertices(mesh, views, projectedMeshes(mesh, views), members, start, options, cpuTemplateSearch,
                         progress);
  }
};

// Pattern of waves that does not repeat within the search radius.
double bricks(double x, double y) {
  return 120 + 28 * std::sin(9 * x + 2 * y) + 28 * std::sin(7 * y - 4 * x + 1) + 28 * std::sin(5.3 * x - 3.7 * y + 2) +
         28 * std::sin(3.1 * y + 2.3 * x);
}

}  // namespace

TEST_CASE("a flat template has no match, whatever the texture threshold", "[N12][T24]") {
  const Image8 flat = pictureOf(40, 30, [](double, double) { return 80; });
  const auto samples = samplesOf({10, 10}, 8, {0, 0}, [](double, double) { return 80; });
  for (const double least : {0.0, 1e-300, 2.0, 255.0})
    for (const glm::dvec2 start : {glm::dvec2(0), {5, -3}, {1e6, -1e6}}) {
      const VertexMatch match = refinedMatch(flat, samples, start, least);
      CHECK(match.displacement == glm::vec2(0));
      CHECK(match.information == glm::vec3(0));
    }
  CHECK(refinedMatch(flat, {}, {3, 4}, 2).information == glm::vec3(0));
  // A textured template has no match in a flat picture either.
  CHECK(refinedMatch(flat, samplesOf({10, 10}, 8, {0, 0}, waves), {1, 1}, 2).information == glm::vec3(0));
}

TEST_CASE("a ramp gives information along its gradient only", "[N12]") {
  for (int degrees = 0; degrees < 360; degrees += 15) {
    INFO(degrees);
    const double angle = degrees * std::numbers::pi / 180;
    const glm::dvec2 along(std::cos(angle), std::sin(angle)), across(-along.y, along.x);
    const auto ramp = [&](double x, double y) { return 128 + 6 * glm::dot(along, glm::dvec2(x - 20, y - 20)); };
    const Image8 picture = pictureOf(40, 40, ramp);
    // Lucas–Kanade subtracts the mean, so on a ramp the result depends on the start alone.
    for (const glm::dvec2 start : {glm::dvec2(0), {2, 1}, {-1, 3}}) {
      const VertexMatch match = refinedMatch(picture, samplesOf({16, 16}, 8, {0, 0}, ramp), start, 2);
      REQUIRE(finite(match));
      CHECK(std::abs(glm::dot(across, glm::dvec2(match.displacement))) < 0.15);
      const glm::dvec3 w(match.information);
      const double acrossInformation =
          across.x * across.x * w.x + 2 * across.x * across.y * w.y + across.y * across.y * w.z;
      const double alongInformation = along.x * along.x * w.x + 2 * along.x * along.y * w.y + along.y * along.y * w.z;
      CHECK(alongInformation > 1);
      CHECK(acrossInformation < 0.01 * alongInformation);
    }
  }
}

TEST_CASE("stripes are located along their gradient to a tenth of a pixel") {
  for (const double angle : {0.0, 0.4, 1.2, 2.5}) {
    const glm::dvec2 along(std::cos(angle), std::sin(angle));
    const auto stripes = [&](double x, double y) {
      return 128 + 70 * std::sin(0.5 * glm::dot(along, glm::dvec2(x, y)));
    };
    const Image8 picture = pictureOf(60, 60, stripes);
    for (const double shift : {0.0, 0.3, -0.45}) {
      const VertexMatch match = refinedMatch(picture, samplesOf({20, 20}, 16, shift * along, stripes), {0, 0}, 2);
      CHECK(glm::distance(glm::dvec2(match.displacement), shift * along) < 0.1);
      CHECK(semidefinite(match));
    }
  }
}

TEST_CASE("a planted displacement is recovered to a tenth of a pixel, also under another exposure", "[N12]") {
  const Image8 picture = pictureOf(80, 80, waves);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> part(-0.7, 0.7);
  for (int run = 0; run < 40; ++run) {
    const glm::ivec2 whole(int(random() % 9) - 4, int(random() % 9) - 4);
    const glm::dvec2 shift = glm::dvec2(whole) + glm::dvec2(part(random), part(random));
    for (const auto& [gain, offset] : {std::pair(1.0, 0.0), {1.0, 20.0}, {0.9, -10.0}}) {
      const auto lit = [&, gain = gain, offset = offset](double x, double y) { return gain * waves(x, y) + offset; };
      const VertexMatch match = refinedMatch(picture, samplesOf({32, 32}, 14, shift, lit), whole, 2);
      CHECK(glm::distance(glm::dvec2(match.displacement), shift) < 0.1);
      CHECK(match.information.x > 1);
      CHECK(match.information.z > 1);
      CHECK(semidefinite(match));
    }
  }
}

TEST_CASE("refined matches are finite and near their start", "[N12]") {
  std::mt19937 random(2);
  const Image8 noise = pictureOf(30, 20, [&](double, double) { return int(random() % 256); });
  const Image8 dot = pictureOf(1, 1, [](double, double) { return 7; });
  for (int run = 0; run < 300; ++run) {
    const glm::dvec2 start(double(random() % 81) - 40, double(random() % 81) - 40);
    auto samples = samplesOf({int(random() % 40) - 5, int(random() % 30) - 5}, 1 + int(random() % 9), {0, 0},
                             [&](double, double) { return int(random() % 256); });
    for (const Image8* picture : {&noise, &dot})
      for (const double least : {0.0, 2.0}) {
        const VertexMatch match = refinedMatch(*picture, samples, start, least);
        REQUIRE(finite(match));
        CHECK(semidefinite(match));
        CHECK(glm::length(match.displacement) <= glm::length(start) + 1.5);
      }
  }
}

TEST_CASE("matches of a wall's vertices equal the rotated camera's displacements, with both measures") {
  const Wall wall(bricks);
  const std::size_t n = wall.mesh.positions.size();
  const auto truth = test::trueComplements(wall.mesh, wall.truly, wall.given);
  double largest = 0;
  for (const glm::vec2& c : truth) largest = std::isnan(c.x) ? largest : std::max(largest, double(glm::length(c)));
  REQUIRE(largest > 1);
  for (const TemplateMeasure measure : {absoluteDifferences, correlation}) {
    const auto matches = wall.matched(measure);
    REQUIRE(matches.size() == 4 * n);
    std::size_t known = 0, near = 0;
    for (std::size_t k = 0; k < matches.size(); ++k) {
      const std::size_t i = k / n / 2, j = k / n % 2;
      REQUIRE(finite(matches[k]));
      if (i == j) CHECK(matches[k].information == glm::vec3(0));
      if (matches[k].information == glm::vec3(0)) continue;
      if (std::isnan(truth[k].x)) continue;  // outside the wall in the other picture
      ++known;
      const double off = glm::distance(matches[k].displacement, truth[k]);
      near += off < 0.15;
      CHECK(off < 0.5);  // at the wall's rim a segment lies on one side of its vertex
    }
    CHECK(known > n);
    CHECK(double(near) > 0.9 * double(known));
    const auto twice = wall.matched(measure, {}, 2);
    for (std::size_t k = 0; k < matches.size(); ++k) {
      CHECK(twice[k].displacement == matches[k].displacement);
      CHECK(twice[k].information == matches[k].information);
    }
  }
}

TEST_CASE("the search is centred on its start") {
  const Wall wall(bricks, 0.05);  // a rotation of about 9 px
  VertexMatchOptions options;
  options.radius = 3;
  const auto truth = test::trueComplements(wall.mesh, wall.truly, wall.given);
  std::vector<glm::vec2> start = truth;
  for (glm::vec2& c : start) c = std::isnan(c.x) ? glm::vec2(0) : c + glm::vec2(1.5f, -1);
  const auto matches = wall.matched(options, start);
  std::size_t known = 0;
  for (std::size_t k = 0; k < matches.size(); ++k)
    if (matches[k].information != glm::vec3(0) && !std::isnan(truth[k].x)) {
      ++known;
      CHECK(glm::distance(matches[k].displacement, truth[k]) < 1.0);  // at this rotation a segment is deformed
    }
  CHECK(known > 20);
}

TEST_CASE("vertices without texture, members or a view have no match", "[N12][T24]") {
  const auto nothing = [](const std::vector<VertexMatch>& matches) {
    return std::ranges::all_of(
        matches, [](const VertexMatch& m) { return m.information == glm::vec3(0) && m.displacement == glm::vec2(0); });
  };
  const Wall plain([](double, double) { return 90; });
  CHECK(nothing(plain.matched(absoluteDifferences)));
  CHECK(nothing(plain.matched(correlation)));
  Wall wall(bricks);
  wall.members.assign(wall.members.size(), 2);
  CHECK(nothing(wall.matched(absoluteDifferences)));
  wall.members.assign(wall.members.size(), 3);
  wall.members[24] = 1;
  const auto matches = wall.matched(absoluteDifferences);
  const std::size_t n = wall.members.size();
  CHECK(!nothing(matches));
  CHECK((matches[n + 24].information == glm::vec3(0) && matches[2 * n + 24].information == glm::vec3(0)));
  wall.views[1].mask = Image8(160, 120, 1);
  const auto masked = wall.matched(absoluteDifferences);  // camera 1 gives no templates, but its picture is searched
  CHECK(nothing({masked.begin() + std::ptrdiff_t(n), masked.begin() + std::ptrdiff_t(2 * n)}));
  // On a wall of stripes along y, the displacement along y is unknown.
  const Wall stripes([](double x, double) { return 120 + 90 * std::sin(9 * x); });
  std::size_t known = 0;
  for (const VertexMatch& m : stripes.matched(absoluteDifferences))
    if (m.information != glm::vec3(0)) {
      ++known;
      CHECK(m.information.z < 0.02f * m.information.x);
      CHECK(std::abs(m.displacement.y) < 0.3);
    }
  CHECK(known > n / 2);
}

TEST_CASE("matches do not depend on the portion size of the template search") {
  const Wall wall(bricks);
  VertexMatchOptions options;
  options.threads = 2;
  std::mutex mutex;
  std::size_t calls = 0, most = 0, all = 0;
  const TemplateSearchFactory counted = [&](std::span<const Image8* const> pictures) -> TemplateSearch {
    return [&, search = cpuTemplateSearch(pictures)](std::span<const TemplateTask> tasks,
                                                     std::span<const TemplateSample> samples, int radius,
                                                     TemplateMeasure measure) {
      const std::lock_guard lock(mutex);
      if (tasks.size() > 1) most = std::max(most, samples.size());
      ++calls;
      all += samples.size();
      return search(tasks, samples, radius, measure);
    };
  };
  const auto matched = [&](std::size_t portion, std::span<const glm::vec2> start = {}) {
    options.portion = portion;
    calls = most = all = 0;
    return matchVertices(wall.mesh, wall.views, projectedMeshes(wall.mesh, wall.views), wall.members, start, options,
                         counted, {});
  };
  const std::vector<VertexMatch> whole = matched(kTemplatePortion);
  CHECK(calls == 4);  // two cameras, two scales
  const std::size_t samples = all;
  std::vector<glm::vec2> start;
  for (const VertexMatch& match : whole) start.push_back(match.displacement);
  const std::vector<VertexMatch> wholeAgain = matched(kTemplatePortion, start);
  for (const std::size_t portion : {std::size_t(1), std::size_t(700), std::size_t(5000), samples}) {
    INFO(portion);
    for (const bool again : {false, true}) {
      const std::vector<VertexMatch> parts = matched(portion, again ? start : std::vector<glm::vec2>());
      CHECK(most <= portion);
      CHECK(calls >= all / std::max<std::size_t>(portion, kMaxTemplateSampleCount));
      CHECK((portion > 1 || calls > 100));
      const std::vector<VertexMatch>& expected = again ? wholeAgain : whole;
      REQUIRE(parts.size() == expected.size());
      for (std::size_t k = 0; k < parts.size(); ++k) {
        CHECK(parts[k].displacement == expected[k].displacement);
        CHECK(parts[k].information == expected[k].information);
        CHECK(parts[k].cost == expected[k].cost);
      }
    }
  }
}

TEST_CASE("matching can be cancelled") {
  const Wall wall(bricks);
  VertexMatchOptions options;
  CHECK(test::errorOf([&] { wall.matched(options, {}, [](const Progress&) { return false; }); }).code() ==
        ErrorCode::cancelled);
}

}  // namespace ibr
