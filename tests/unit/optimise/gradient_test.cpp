// SPDX-License-Identifier: Apache-2.0
// AlignmentMethod::gradient and its priors.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "ibr/error.h"
#include "optimise/ecc_step.h"
#include "support/planted.h"

using namespace ibr;

namespace {

AlignmentOptions patient() {
  AlignmentOptions options;
  options.method = AlignmentMethod::gradient;
  options.decay = 0.6;
  options.threshold = 1e-5;
  options.maxCycles = 14;
  return options;
}

struct Seen {
  StarMesh mesh;
  std::vector<Texels> pictures;
  explicit Seen(const Alignment& a) : mesh(starMeshOf(a)) {
    for (const Image8* picture : a.pictures) pictures.push_back(texelsOf(*picture));
  }
  JudgeInput input() const { return {mesh, pictures}; }
};

}  // namespace

TEST_CASE("the gradient method finds planted shifts to a tenth of a pixel", "[N3]") {
  const int members = GENERATE(2, 3, 4);
  const auto definition = GENERATE(EccDefinition::channels, EccDefinition::concatenated);
  const int levels = GENERATE(1, 2);
  auto planted = test::planted(members, 112, 4, 2.5, 7);
  const double before = test::matchError(planted).mean;
  AlignmentOptions options = patient();
  options.definition = definition;
  options.levels = levels;
  const AlignmentSummary summary = align(planted.alignment, options);
  const test::MatchError after = test::matchError(planted);
  CAPTURE(members, int(definition), levels, before, after.mean, after.largest, summary.initialEcc, summary.finalEcc);
  CHECK(before > 1.0);
  CHECK(after.mean < 0.1);
  CHECK(summary.finalEcc > summary.initialEcc);
}

TEST_CASE("gradient steps find displaced points without random candidates") {
  auto planted = test::planted(3, 112, 4, 1.2, 3);
  AlignmentOptions options = patient();
  options.escape = 0;
  align(planted.alignment, options);
  CHECK(test::matchError(planted).mean < 0.1);
}

// The guard is called after a class's moves are made; no other point of the star moves in the same step.
TEST_CASE("a gradient step never lowers the ECC of its star", "[N3]") {
  auto planted = test::planted(3, 112, 6, 2.0, 11);
  const Seen seen(planted.alignment);
  Positions at = planted.alignment.position;
  std::size_t asked = 0, lower = 0;
  AlignmentOptions options = patient();
  options.definition = GENERATE(EccDefinition::channels, EccDefinition::concatenated);
  options.guard = [&](std::uint32_t point, std::span<const glm::ivec2> now) {
    std::size_t member = 0;
    while (member < at.size() && at[member][point] == now[member]) ++member;
    REQUIRE(member < at.size());
    const auto score = [&](glm::ivec2 offset) {
      return judge(seen.input(), at, point, member, offset).score(options.definition, options.varianceFloor);
    };
    const glm::ivec2 offset = now[member] - at[member][point];
    REQUIRE(fits(seen.mesh, at, point, member, offset));
    if (!shader::eccWins(score(offset), score(glm::ivec2(0)))) ++lower;
    at[member][point] = now[member];
    ++asked;
    return true;
  };
  align(planted.alignment, options);
  CHECK(asked > 100);
  CHECK(lower == 0);
}

TEST_CASE("the gradient method gives the same mesh on any number of threads", "[N3]") {
  std::vector<Positions> found;
  for (const int threads : {1, 1, 2, 5}) {
    auto planted = test::planted(3, 112, 6, 2.0, 5);
    AlignmentOptions options = patient();
    options.threads = threads;
    options.levels = 2;
    options.maxCycles = 4;
    align(planted.alignment, options);
    found.push_back(planted.alignment.position);
  }
  CHECK(found[1] == found[0]);
  CHECK(found[2] == found[0]);
  CHECK(found[3] == found[0]);
}

TEST_CASE("no point moves in constant images") {
  auto planted = test::planted(2, 112, 4, 2.0, 5);
  for (Image8& picture : planted.pictures) std::ranges::fill(picture.values, std::uint8_t(90));
  const Positions before = planted.alignment.position;
  AlignmentOptions options = patient();
  options.definition = GENERATE(EccDefinition::channels, EccDefinition::concatenated);
  options.levels = 2;
  align(planted.alignment, options);
  CHECK(planted.alignment.position == before);
}

TEST_CASE("rigidity keeps points of an untextured half, and the textured half is aligned") {
  auto planted = test::planted(2, 112, 6, 2.0, 5);
  const std::size_t n = planted.alignment.position[0].size();
  std::mt19937 random(2);
  for (Image8& picture : planted.pictures)
    for (int y = 0; y < 56; ++y)
      for (int x = 0; x < picture.width; ++x)
        for (auto& value : picture.pixel(x, y)) value = std::uint8_t(199 + random() % 3);
  Positions start = planted.alignment.position;
  const auto furthest = [&](double rigidity, bool sky) {
    Alignment a = planted.alignment;
    AlignmentOptions options = patient();
    options.rigidity = rigidity;
    align(a, options);
    double most = 0;
    for (std::size_t p = 0; p < n; ++p) {
      // Stars of rows 0 and 1 are above the horizon in both pictures, stars of rows 5 and 6 below.
      const std::size_t row = p / 7;
      if (sky ? row > 1 : row < 5) continue;
      for (std::size_t i = 0; i < 2; ++i)
        most = std::max(most, glm::length(glm::dvec2(a.position[i][p] - start[i][p])) / kAlignmentUnitsPerPixel);
    }
    return most;
  };
  CHECK(furthest(0, true) > 0.5);  // noise is aligned with noise
  CHECK(furthest(40, true) < 0.15);
  CHECK(furthest(40, false) > 0.5);
}

TEST_CASE("epipolarWeight keeps points near their epipolar lines") {
  auto planted = test::planted(2, 112, 4, 2.0, 5);
  const Positions start = planted.alignment.position;
  // The lines are horizontal, so the vertical part of the points' errors cannot be corrected along them.
  planted.alignment.epipolar.assign(2, std::vector<glm::vec2>(start[0].size(), glm::vec2(1, 0)));
  const auto off = [&](double weight) {
    Alignment a = planted.alignment;
    AlignmentOptions options = patient();
    options.epipolarWeight = weight;
    align(a, options);
    glm::dvec2 sum(0);
    for (std::size_t i = 0; i < 2; ++i)
      for (std::size_t p = 0; p < start[i].size(); ++p)
        sum += glm::abs(glm::dvec2(a.position[i][p] - start[i][p])) / double(kAlignmentUnitsPerPixel);
    return sum / double(2 * start[0].size());
  };
  const glm::dvec2 free = off(0), held = off(10000);
  CAPTURE(free.x, free.y, held.x, held.y);
  CHECK(free.y > 0.2);
  CHECK(held.y < 0.05 * free.y);
  CHECK(held.x > 0.2);
}

TEST_CASE("epipolar directions of the wrong number are refused") {
  auto planted = test::planted(2, 112, 4, 2.0, 5);
  const Positions before = planted.alignment.position;
  planted.alignment.epipolar.assign(2, std::vector<glm::vec2>(before[0].size() - 1));
  CHECK_THROWS_AS(align(planted.alignment, patient()), Error);
  planted.alignment.epipolar.assign(1, std::vector<glm::vec2>(before[0].size()));
  CHECK_THROWS_AS(align(planted.alignment, patient()), Error);
  CHECK(planted.alignment.position == before);
}

TEST_CASE("points of the border slide along the border") {
  auto planted = test::planted(2, 112, 4, 2.0, 9);
  // The upper border is a horizontal line in both pictures: its points may slide, but do not leave the line.
  const Positions start = planted.alignment.position;
  align(planted.alignment, patient());
  int slid = 0;
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t p = 1; p < 4; ++p) {
      CHECK(planted.alignment.position[i][p].y == start[i][p].y);
      slid += planted.alignment.position[i][p].x != start[i][p].x;
    }
  CHECK(slid > 0);
}

TEST_CASE("gradient sums match finite differences of the ECC") {
  auto planted = test::planted(3, 112, 3, 1.0, 21);
  const Seen seen(planted.alignment);
  const std::uint32_t point = 5;
  const GradientSums sums =
      gradientSums(seen.input(), planted.alignment.position, point, 1, glm::ivec2(0), EccDefinition::channels, 25);
  const auto ecc = [&](glm::ivec2 offset) {
    return eccOf(judge(seen.input(), planted.alignment.position, point, 1, offset).score(EccDefinition::channels, 25));
  };
  const shader::EccScore score =
      judge(seen.input(), planted.alignment.position, point, 1, glm::ivec2(0)).score(EccDefinition::channels, 25);
  CHECK(sums.xx == Approx(double(score.varianceX) / 65536).epsilon(1e-3));
  CHECK(sums.yy == Approx(double(score.varianceY) / 65536).epsilon(1e-3));
  CHECK(sums.xy == Approx(double(score.covariance) / 65536).epsilon(1e-3));
  // d ECC = (yg − (xy / xx) xg) / √(xx yy)
  const glm::dvec2 slope = (sums.yg - sums.xg * (sums.xy / sums.xx)) / std::sqrt(sums.xx * sums.yy);
  constexpr int kHalf = 32;
  const glm::dvec2 measured =
      glm::dvec2(ecc({kHalf, 0}) - ecc({-kHalf, 0}), ecc({0, kHalf}) - ecc({0, -kHalf})) / (2.0 * kHalf / 128);
  CAPTURE(slope.x, slope.y, measured.x, measured.y);
  CHECK(glm::length(slope - measured) < 0.15 * glm::length(measured));
  CHECK(glm::length(measured) > 0.003);
}

TEST_CASE("the closed-form step finds the displacement of a linear signal") {
  // Source x, target y = 3(x + g·d) with d = (0.7, −0.4); 4000 samples suffice.
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0, 1);
  const glm::dvec2 d(0.7, -0.4);
  GradientSums sums;
  for (int i = 0; i < 4000; ++i) {
    const double x = 20 * normal(random);
    const glm::dvec2 g(8 * normal(random), 5 * normal(random) + 0.1 * x);
    const double y = 3 * (x + glm::dot(g, d));
    sums.samples += 1;
    sums.xx += x * x, sums.xy += x * y, sums.yy += y * y;
    sums.xg += g * x, sums.yg += g * y;
    sums.g00 += g.x * g.x, sums.g01 += g.x * g.y, sums.g11 += g.y * g.y;
  }
  const auto step = eccStep(sums, {}, glm::dvec2(0), std::nullopt);
  REQUIRE(step);
  CHECK(glm::length(*step - d) < 0.01);
  const auto along = eccStep(sums, {}, glm::dvec2(0), glm::dvec2(1, 0));
  REQUIRE(along);
  CHECK(along->y == 0);
  CHECK(along->x == Approx(d.x).margin(0.05));
  const auto held = eccStep(sums, {glm::dmat2(1e7)}, glm::dvec2(0.5, 0), std::nullopt);
  REQUIRE(held);
  CHECK(glm::length(*held - glm::dvec2(-0.5, 0)) < 0.01);  // back at the start
  CHECK_FALSE(eccStep(GradientSums{}, {}, glm::dvec2(0), std::nullopt));
}
