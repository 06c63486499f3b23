// SPDX-License-Identifier: Apache-2.0
// Edge flips: wrong diagonals are corrected, right ones stay, and no triangle folds over.
#include "optimise/topology.h"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <set>

#include "base/bilinear.h"
#include "base/raster.h"
#include "optimise/star_mesh.h"
#include "shared/ecc.h"
#include "support/error_of.h"
#include "support/mesh_checks.h"
#include "support/planted.h"

using namespace ibr;
using namespace ibr::test;

namespace {

constexpr int kSide = 128, kCells = 4;

std::size_t flip(Alignment& alignment, const FlipOptions& options = {}) {
  return flipEdges(alignment, texelsOfAll(alignment), options);
}

// The second picture shows the first one bent along the edges of a mesh, with an affine map for each triangle.
struct Bent {
  test::Planted planted = test::planted(2, kSide, kCells, 0, 21);
  Alignment& alignment = planted.alignment;
  std::vector<glm::uvec3> right;

  explicit Bent(double noise = 0) {
    std::mt19937 random(22);
    std::vector<glm::ivec2>&first = alignment.position[0], &second = alignment.position[1];
    second = first;
    for (std::size_t p = 0; p < first.size(); ++p) {
      const int x = int(p) % (kCells + 1), y = int(p) / (kCells + 1);
      if (x > 0 && y > 0 && x < kCells && y < kCells)
        second[p] += glm::ivec2((x + y) % 2 ? 400 : -400, int(random() % 400) - 200);
    }
    for (std::size_t square = 0; square < alignment.triangles.size() / 2; square += 3) turnDiagonal(square);
    right = alignment.triangles;
    for (const glm::uvec3& t : right) {
      const auto at = [&](std::size_t i, unsigned p) {
        return glm::dvec2(alignment.position[i][p]) / double(kAlignmentUnitsPerPixel);
      };
      forTrianglePixels(at(1, t.x), at(1, t.y), at(1, t.z), kSide, kSide, [&](int x, int y, const glm::dvec3& w) {
        const glm::dvec3 colour = bilinear(planted.pictures[0], w.x * at(0, t.x) + w.y * at(0, t.y) + w.z * at(0, t.z));
        for (int c = 0; c < 3; ++c) planted.pictures[1].pixel(x, y)[std::size_t(c)] = std::uint8_t(colour[c] + 0.5);
      });
    }
    addNoise(planted, noise);
  }

  static void addNoise(test::Planted& planted, double deviation) {
    std::mt19937 random(23);
    std::normal_distribution<double> normal(0, deviation > 0 ? deviation : 1);
    for (Image8& picture : planted.pictures)
      for (auto& v : picture.values)
        if (deviation > 0) v = std::uint8_t(std::clamp(v + normal(random), 0.0, 255.0));
  }

  // Triangles 2n and 2n + 1 form a square.
  void turnDiagonal(std::size_t square) {
    glm::uvec3 &s = alignment.triangles[2 * square], &t = alignment.triangles[2 * square + 1];
    const std::set<unsigned> first{s.x, s.y, s.z}, second{t.x, t.y, t.z};
    std::set<unsigned> all = first;
    all.insert(second.begin(), second.end());
    const std::vector<unsigned> corner(all.begin(), all.end());  // layout: 0 1 / 2 3
    REQUIRE(corner.size() == 4);
    if (first.contains(corner[0]) && second.contains(corner[0])) {
      s = {corner[0], corner[1], corner[2]}, t = {corner[1], corner[3], corner[2]};
    } else {
      s = {corner[0], corner[1], corner[3]}, t = {corner[0], corner[3], corner[2]};
    }
  }
};

}  // namespace

TEST_CASE("only the wrong diagonals of a bent surface are flipped") {
  Bent bent(GENERATE(0.0, 6.0));
  std::size_t wrong = 0;
  for (const std::size_t square : {1, 5, 6, 11}) {
    bent.turnDiagonal(square);
    ++wrong;
  }
  REQUIRE(cornersOf(bent.alignment.triangles) != cornersOf(bent.right));
  CHECK(flip(bent.alignment) == wrong);
  CHECK(cornersOf(bent.alignment.triangles) == cornersOf(bent.right));
  for (std::size_t square = 0; square < bent.right.size() / 2; ++square)  // triangles keep the indices of their square
    CHECK(cornersOf({bent.alignment.triangles[2 * square], bent.alignment.triangles[2 * square + 1]}) ==
          cornersOf({bent.right[2 * square], bent.right[2 * square + 1]}));
}

TEST_CASE("no edge flips in a correct mesh or without texture") {
  SECTION("bent surface") {
    Bent bent(GENERATE(0.0, 6.0));
    CHECK(flip(bent.alignment) == 0);
    CHECK(bent.alignment.triangles == bent.right);
  }
  SECTION("flat surface under noise, a tenth of a pixel off") {
    auto planted = test::planted(GENERATE(2, 3), 96, GENERATE(3, 6, 20), 0.1, 24);
    Bent::addNoise(planted, 16);
    CHECK(flip(planted.alignment) == 0);
  }
  SECTION("noise only, or constant images") {
    auto planted = test::planted(2, 96, 4, 0, 25);
    for (Image8& picture : planted.pictures) picture = Image8(96, 96, 3, 90);
    Bent::addNoise(planted, GENERATE(0.0, 3.0));
    CHECK(flip(planted.alignment) == 0);
  }
}

// Without texture both diagonals are equal; a negative minimum gain flips all edges that may flip.
TEST_CASE("edge flips never fold a triangle over", "[N4][P8]") {
  const Image8 grey(64, 64, 3, 90);
  const int members = GENERATE(2, 3, 4);
  const std::vector<Texels> texels(std::size_t(members), texelsOf(grey));
  std::mt19937 random(26);
  const auto upTo = [&](int most) { return int(random() % unsigned(most + 1)); };
  int flipped = 0, refused = 0, needles = 0;
  for (int round = 0; round < 100000; ++round) {
    Alignment a;
    const int tall = upTo(11), height = 1 << tall, jitter = 1 << upTo(std::min(tall, 9));
    std::array<glm::ivec2, 4> base{};
    for (glm::ivec2& at : base) at = {1000 + upTo(2000), 1000 + upTo(height)};
    for (int i = 0; i < members; ++i) {
      a.pictures.push_back(&grey);
      auto& at = a.position.emplace_back();
      for (const glm::ivec2& corner : base) at.push_back(corner + glm::ivec2(upTo(jitter), upTo(jitter)));
    }
    a.triangles = {{0, 1, 2}, {0, 2, 3}};
    if (foldedAnywhere(a.position, a.triangles[0]) || foldedAnywhere(a.position, a.triangles[1])) continue;
    const auto before = a.triangles;
    const std::vector<glm::uvec3> other{{0, 1, 3}, {1, 2, 3}};
    const bool may = !foldedAnywhere(a.position, other[0]) && !foldedAnywhere(a.position, other[1]);
    if (flipEdges(a, texels, {.gain = -1, .maxPasses = 1, .threads = 1}) == 0) {
      CHECK(a.triangles == before);
      refused += !may;
      continue;
    }
    ++flipped;
    needles += height <= 2 * kAlignmentUnitsPerPixel;
    if (!may || cornersOf(a.triangles) != cornersOf(other)) FAIL_CHECK("round " << round);
    for (const glm::uvec3& t : a.triangles)
      if (foldedAnywhere(a.position, t)) FAIL_CHECK("folded in round " << round);
  }
  CAPTURE(members, flipped, refused, needles);
  CHECK(flipped > 1000);
  CHECK(refused > 1000);
  CHECK(needles > 200);
}

TEST_CASE("edge flips keep the number, area and border of triangles", "[N4]") {
  const auto flippedOften = [](int threads) {
    Bent bent;
    flip(bent.alignment, {.gain = -1, .maxPasses = 7, .threads = threads});
    return bent.alignment.triangles;
  };
  const Bent bent;
  const std::vector<glm::uvec3> triangles = flippedOften(1);
  CHECK(triangles == flippedOften(1));
  CHECK(triangles == flippedOften(3));
  CHECK(cornersOf(triangles) != cornersOf(bent.right));
  REQUIRE(triangles.size() == bent.right.size());
  CHECK(borderOf(triangles) == borderOf(bent.right));
  for (const auto& at : bent.alignment.position) {
    std::int64_t area = 0;
    for (const glm::uvec3& t : triangles) area += shader::eccArea(at[t.x], at[t.y], at[t.z]);
    for (const glm::uvec3& t : bent.right) area -= shader::eccArea(at[t.x], at[t.y], at[t.z]);
    CHECK(area == 0);
  }
  for (const glm::uvec3& t : triangles) CHECK(!foldedAnywhere(bent.alignment.position, t));
}

TEST_CASE("edges of kept triangles and between movable and fixed points do not flip") {
  Bent bent;
  bent.turnDiagonal(5);
  const auto wrong = bent.alignment.triangles;
  const glm::uvec3 s = wrong[10], t = wrong[11];
  std::vector<unsigned> shared;
  for (int k = 0; k < 3; ++k)
    if (s[k] == t.x || s[k] == t.y || s[k] == t.z) shared.push_back(s[k]);
  REQUIRE(shared.size() == 2);
  bent.alignment.fixed.assign(bent.alignment.position[0].size(), 0);
  SECTION("edge of a kept triangle") {
    bent.alignment.unevaluated.push_back({shared[0], shared[1], 0});
    CHECK(flip(bent.alignment) == 0);
  }
  SECTION("the new edge exists already") {
    unsigned c = 0, d = 0;
    for (int k = 0; k < 3; ++k) {
      if (std::ranges::count(shared, s[k]) == 0) c = s[k];
      if (std::ranges::count(shared, t[k]) == 0) d = t[k];
    }
    bent.alignment.unevaluated.push_back({c, d, 0});
    CHECK(flip(bent.alignment) == 0);
  }
  SECTION("one end fixed") {
    bent.alignment.fixed[shared[0]] = 1;
    CHECK(flip(bent.alignment) == 0);
  }
  SECTION("both ends fixed") {
    for (const unsigned p : shared) bent.alignment.fixed[p] = 1;
    CHECK(flip(bent.alignment) == 1);
  }
}

TEST_CASE("the optimiser flips edges between cycles with flipEdges") {
  AlignmentOptions options;
  options.method = GENERATE(AlignmentMethod::cpu, AlignmentMethod::gradient);
  options.levels = options.method == AlignmentMethod::gradient ? 2 : 1;
  options.threshold = 1e-4;
  const auto run = [&](bool flips) {
    Bent bent;
    for (const std::size_t square : {1, 5, 6, 11}) bent.turnDiagonal(square);
    const auto wrong = bent.alignment.triangles;
    options.flipEdges = flips;
    const AlignmentSummary summary = align(bent.alignment, options);
    std::size_t counted = 0;
    for (std::size_t c = 0; c < summary.bestCycle; ++c) counted += summary.cycles[c].flipped;
    CHECK(summary.flips == counted);
    CHECK(summary.finalEcc == summary.cycles.at(summary.bestCycle - 1).ecc);
    CHECK((bent.alignment.triangles == wrong) == !flips);
    if (flips) CHECK(cornersOf(bent.alignment.triangles) == cornersOf(bent.right));
    for (const glm::uvec3& t : bent.alignment.triangles) CHECK(!foldedAnywhere(bent.alignment.position, t));
    return summary;
  };
  const AlignmentSummary without = run(false), with = run(true), again = run(true);
  CAPTURE(without.initialEcc, without.finalEcc, with.finalEcc, with.flips);
  CHECK(without.flips == 0);
  CHECK(with.flips >= 4);
  CHECK(with.finalEcc > without.finalEcc + 0.002);
  CHECK(again.finalEcc == with.finalEcc);
}

TEST_CASE("cancelling restores the triangles, and flipGain out of range is refused") {
  Bent bent;
  bent.turnDiagonal(5);
  const auto wrong = bent.alignment.triangles;
  AlignmentOptions options;
  options.method = AlignmentMethod::cpu;
  options.flipEdges = true;
  options.threshold = 0;
  std::size_t cycles = 0;
  const auto untilSecond = [&](const Progress& p) { return (cycles = p.done) == 0; };
  CHECK(test::errorOf([&] { align(bent.alignment, options, nullptr, untilSecond); }).code() == ErrorCode::cancelled);
  CHECK(cycles == 1);
  CHECK(bent.alignment.triangles == wrong);
  options.flipGain = -0.1;
  CHECK_THAT(test::errorOf([&] { align(bent.alignment, options); }).what(),
             Catch::Contains("flipGain") && Catch::Contains("-0.1"));
}
