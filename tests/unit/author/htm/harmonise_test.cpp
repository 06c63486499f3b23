// SPDX-License-Identifier: Apache-2.0
// [H] Alg. 2 from end to end, on a small body with exact photographs.
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "small_body.h"
#include "support/error_of.h"

namespace ibr {
namespace {

using test::body;
using test::disturbed;
using test::kCameras;
using test::plainOptions;
using test::theBody;

double medianLength(const std::vector<glm::vec2>& complements) {
  std::vector<double> lengths;
  for (const glm::vec2& c : complements)
    if (c != glm::vec2(0)) lengths.push_back(glm::length(c));
  REQUIRE(lengths.size() > 100);
  std::ranges::nth_element(lengths, lengths.begin() + std::ptrdiff_t(lengths.size() / 2));
  return lengths[lengths.size() / 2];
}

void checkWhole(const HtmResult& result, std::size_t cameras) {
  for (const Fault& fault : validate(result.model)) FAIL_CHECK(fault.field << ": " << fault.message);
  CHECK(result.model.cameras.size() == cameras);
  CHECK(result.visibility.size() == cameras);
  CHECK(result.model.complements.size() == cameras * cameras * result.model.vertexCount());
  CHECK(!result.stages.empty());
  for (const HtmResult::Stage& stage : result.stages) CHECK(stage.difference.size() == stage.mesh.triangles.size());
  for (const HtmReport::Round& round : result.report.rounds) {
    CHECK((std::isfinite(round.unharmonisedDifference) && std::isfinite(round.harmonisedDifference)));
    CHECK((round.matchedShare >= 0 && round.matchedShare <= 1));
  }
  CHECK((result.report.rejected >= 0 && result.report.rejected <= 1));
}

bool same(const HtmResult& a, const HtmResult& b) {
  bool cameras = a.model.cameras.size() == b.model.cameras.size();
  for (std::size_t i = 0; cameras && i < a.model.cameras.size(); ++i) {
    const Camera &x = a.model.cameras[i].camera, &y = b.model.cameras[i].camera;
    cameras = x.pose.position == y.pose.position && x.pose.rotation == y.pose.rotation &&
              x.intrinsics == y.intrinsics && a.visibility[i].values == b.visibility[i].values;
  }
  return cameras && a.model.surface.mesh == b.model.surface.mesh &&
         a.model.surface.members == b.model.surface.members && a.model.complements == b.model.complements;
}

}  // namespace

TEST_CASE("exact cameras and an exact mesh have negligible complements") {
  const HtmResult result = harmonise(theBody().model.surface.mesh, test::photographsOf(theBody()), plainOptions());
  checkWhole(result, kCameras);
  CHECK(medianLength(result.model.complements) < 0.1);
  REQUIRE(result.report.rounds.size() == 1);
  CHECK(result.report.rounds[0].unharmonisedDifference < 2);
  CHECK(result.report.rounds[0].harmonisedDifference < result.report.rounds[0].unharmonisedDifference + 0.1);
  CHECK(result.report.rounds[0].matchedShare > 0.3);
  CHECK(result.report.rejected < 0.12);  // matches at slanted views
  CHECK(result.model.source.has_value());
  CHECK(result.model.source->mesh == theBody().model.surface.mesh);
  for (const HtmCamera& camera : result.model.cameras) CHECK(!camera.given);
}

TEST_CASE("complements or adjustment compensate wrong cameras") {
  const auto photographs = disturbed(test::photographsOf(theBody()));
  const TriangleMesh& mesh = theBody().model.surface.mesh;
  HtmOptions options = plainOptions();
  const HtmResult bent = harmonise(mesh, photographs, options);
  checkWhole(bent, kCameras);
  CHECK(bent.report.rounds[0].harmonisedDifference < 0.6 * bent.report.rounds[0].unharmonisedDifference);
  CHECK(medianLength(bent.model.complements) > 0.8);
  options.adjustRounds = 2;
  const HtmResult adjusted = harmonise(mesh, photographs, options);
  checkWhole(adjusted, kCameras);
  REQUIRE(adjusted.report.adjustments.size() == 2);
  CHECK(adjusted.report.adjustments[0].afterPx < adjusted.report.adjustments[0].beforePx);
  CHECK(adjusted.report.adjustments[1].beforePx < adjusted.report.adjustments[0].beforePx);
  CHECK(adjusted.report.rounds[0].unharmonisedDifference < 0.5 * bent.report.rounds[0].unharmonisedDifference);
  CHECK(adjusted.report.rounds[0].harmonisedDifference <= bent.report.rounds[0].harmonisedDifference);
  for (std::size_t i = 0; i < kCameras; ++i) {
    REQUIRE(adjusted.model.cameras[i].given);
    CHECK(adjusted.model.cameras[i].given->pose.position == photographs[i].camera.camera.pose.position);
  }
}

TEST_CASE("with too few vertices to adjust cameras, the given cameras are used") {
  test::BumpyOptions coarse;
  coarse.cameras = 6;
  coarse.disagreement = 0;
  coarse.longitudes = 8;
  coarse.latitudes = 5;
  const test::BumpyModel bumpy = test::bumpyModel(coarse);
  const auto photographs = disturbed(test::photographsOf(bumpy));
  HtmOptions options = plainOptions();
  options.laterRadius = 1;
  const HtmResult asGiven = harmonise(bumpy.model.surface.mesh, photographs, options);
  options.adjustRounds = 2;
  const HtmResult adjusted = harmonise(bumpy.model.surface.mesh, photographs, options);
  CHECK(adjusted.report.adjustments[0].beforePx > 0.3);
  CHECK(adjusted.report.adjustments[0].meanDisplacement == 0);
  CHECK(adjusted.model.complements == asGiven.model.complements);
}

TEST_CASE("faces are merged and divided as the options say, and the report counts them") {
  const auto photographs = disturbed(test::photographsOf(theBody()));
  HtmOptions options = plainOptions();
  options.faces = 300;
  options.inconsistentShare = 0.1;
  options.inconsistentDifference = 4;
  options.rounds = 2;
  options.meanDifference = 0.1;
  options.faceDifference = 2;
  options.minFacePx = 10;
  std::vector<std::string> reportedStages;
  const HtmResult result = harmonise(theBody().model.surface.mesh, photographs, options, [&](const Progress& p) {
    CHECK((p.total == 0 || p.done <= p.total));
    if (reportedStages.empty() || reportedStages.back() != p.stage) reportedStages.emplace_back(p.stage);
    return true;
  });
  checkWhole(result, kCameras);
  const HtmReport& report = result.report;
  CHECK(report.sourceFaces == theBody().model.surface.mesh.triangles.size());
  CHECK(report.reducedFaces <= 300);
  CHECK(report.collapses > 0);
  REQUIRE(report.rounds.size() == 2);
  CHECK(report.rounds[0].faces == report.reducedFaces - 2 * report.collapses);
  CHECK(report.rounds[0].divided > 0);
  CHECK(report.rounds[1].faces > report.rounds[0].faces);
  CHECK(report.rounds[1].divided == 0);
  CHECK(report.rounds[1].harmonisedDifference < report.rounds[1].unharmonisedDifference);
  CHECK(result.model.surface.mesh.triangles.size() == report.rounds[1].faces);
  CHECK(report.complementBytes == result.model.complements.size() * 8);
  std::vector<std::string> names;
  for (const HtmResult::Stage& stage : result.stages) names.push_back(stage.name);
  CHECK(names == std::vector<std::string>{"original", "reduced by shape", "reduced by texture", "refined"});
  CHECK(reportedStages.size() > 4);
  options.maxFaces = 1;
  options.keepSource = false;
  options.reject = false;
  const HtmResult fewer = harmonise(theBody().model.surface.mesh, photographs, options);
  CHECK(fewer.report.rounds.size() == 1);
  CHECK(!fewer.model.source);
  CHECK(fewer.report.rejected == 0);
}

TEST_CASE("the result is deterministic on any number of threads") {
  const test::BumpyModel bumpy = body(6);
  const auto photographs = disturbed(test::photographsOf(bumpy));
  HtmOptions options = plainOptions();
  options.faces = 250;
  options.inconsistentShare = 0.1;
  options.inconsistentDifference = 4;
  options.adjustRounds = 1;
  options.rounds = 2;
  options.radius = 4;
  const TriangleMesh& mesh = bumpy.model.surface.mesh;
  const HtmResult once = harmonise(mesh, photographs, options);
  CHECK(same(once, harmonise(mesh, photographs, options)));
  options.threads = 2;
  CHECK(same(once, harmonise(mesh, photographs, options)));
}

TEST_CASE("the cameras' order and the world's position do not change a model") {
  const test::BumpyModel bumpy = body(6);
  const auto photographs = disturbed(test::photographsOf(bumpy));
  const TriangleMesh& mesh = bumpy.model.surface.mesh;
  const HtmOptions options = plainOptions();
  const HtmResult result = harmonise(mesh, photographs, options);
  const std::size_t n = photographs.size();
  SECTION("camera order") {
    std::vector<HtmPhotograph> turned(photographs.rbegin(), photographs.rend());
    const HtmResult other = harmonise(mesh, turned, options);
    CHECK(other.report.rounds[0].harmonisedDifference == Approx(result.report.rounds[0].harmonisedDifference));
    int different = 0;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v)
      for (std::size_t i = 0; i < n; ++i) {
        const CameraSet a = result.model.surface.members[v], b = other.model.surface.members[v];
        if ((a >> i & 1) != (b >> (n - 1 - i) & 1)) {
          ++different;
          continue;
        }
        for (std::size_t j = 0; j < n; ++j)
          different +=
              glm::distance(result.model.complements[result.model.complementIndex(i, j, v)],
                            other.model.complements[other.model.complementIndex(n - 1 - i, n - 1 - j, v)]) > 1e-4;
      }
    CHECK(different < 20);  // vertices where camera sets of equal size and equal scores tie
  }
  SECTION("world position") {
    const glm::dvec3 away(1e5, -2e5, 3e5);
    std::vector<HtmPhotograph> there = photographs;
    for (HtmPhotograph& p : there) p.camera.camera.pose.position += away;
    const HtmResult other = harmonise(test::moved(mesh, away), there, options);
    CHECK(other.report.rounds[0].harmonisedDifference ==
          Approx(result.report.rounds[0].harmonisedDifference).epsilon(1e-3));
    CHECK(other.report.camerasPerVertex == Approx(result.report.camerasPerVertex).epsilon(1e-3));
    std::vector<double> apart;
    for (std::size_t k = 0; k < result.model.complements.size(); ++k)
      apart.push_back(glm::distance(result.model.complements[k], other.model.complements[k]));
    std::ranges::sort(apart);
    CHECK(apart[apart.size() * 99 / 100] < 0.01);
  }
}

TEST_CASE("a camera with an unrelated image does not contribute") {
  auto photographs = test::photographsOf(theBody());
  std::mt19937 random(4);
  Image8& picture = photographs[3].picture;
  for (int y = 0; y < picture.height; y += 4)
    for (int x = 0; x < picture.width; x += 4) {
      const std::array colour{random(), random(), random()};
      for (int k = 0; k < 16; ++k)
        for (std::size_t c = 0; c < 3; ++c) picture.pixel(x + k % 4, y + k / 4)[c] = std::uint8_t(colour[c]);
    }
  HtmOptions options = plainOptions();
  const auto sharesOf = [&] {
    const HtmResult result = harmonise(theBody().model.surface.mesh, photographs, options);
    checkWhole(result, kCameras);
    std::array<double, 2> share{};  // of camera 3 and of the others, at vertices that three or more cameras see
    std::array<double, 2> had{};
    for (std::size_t v = 0; v < result.model.vertexCount(); ++v) {
      const CameraSet before = result.model.source->members[v], after = result.model.surface.members[v];
      CHECK((after & ~before) == 0);
      if (std::popcount(before) < 3) continue;
      for (std::size_t i = 0; i < kCameras; ++i)
        if (before >> i & 1) ++had[i != 3], share[i != 3] += double(after >> i & 1);
      for (std::size_t j = 0; j < kCameras; ++j)
        if ((after >> 3 & 1) == 0)
          CHECK(result.model.complements[result.model.complementIndex(3, j, v)] == glm::vec2(0));
    }
    REQUIRE(had[0] > 20);
    return std::array{share[0] / had[0], share[1] / had[1]};
  };
  const auto rejected = sharesOf();
  CHECK(rejected[0] < 0.1);
  CHECK(rejected[1] > 0.9);
  options.reject = false;
  CHECK(sharesOf() == std::array{1.0, 1.0});
}

TEST_CASE("a single camera gives a model, and masks bound its visibility") {
  auto photographs = test::photographsOf(theBody());
  photographs.resize(1);
  HtmOptions options;
  options.faces = 200;
  options.threads = 1;
  const HtmResult result = harmonise(theBody().model.surface.mesh, photographs, options);
  checkWhole(result, 1);
  for (const glm::vec2& c : result.model.complements) CHECK(c == glm::vec2(0));
  CHECK(result.report.rounds.back().harmonisedDifference == 0);
  photographs[0].mask = Image8(160, 120, 1);
  CHECK(test::errorOf([&] { harmonise(theBody().model.surface.mesh, photographs, options); }).code() ==
        ErrorCode::invalidInput);
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 160; ++x) photographs[0].mask.pixel(x, y)[0] = 255;
  const HtmResult half = harmonise(theBody().model.surface.mesh, photographs, options);
  CHECK(half.report.camerasPerVertex < 0.8 * result.report.camerasPerVertex);
  for (int x = 0; x < 160; ++x) CHECK(half.visibility[0].pixel(x, 60)[0] == 0);
}

}  // namespace ibr
