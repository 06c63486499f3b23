// SPDX-License-Identifier: Apache-2.0
// Point insertion: points are added where the mesh is too coarse, and only there; the mesh stays closed.
#include "optimise/insertion.h"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <set>

#include "base/bilinear.h"
#include "base/raster.h"
#include "shared/ecc.h"
#include "support/error_of.h"
#include "support/mesh_checks.h"
#include "support/planted.h"

using namespace ibr;
using namespace ibr::test;

namespace {

constexpr int kSide = 160, kSquares = 4;  // a triangle has 648 samples
constexpr int kUnits = kAlignmentUnitsPerPixel;

// Options without rigidity; points may be inserted where the ECC is below 0.99.
AlignmentOptions optionsWith(AlignmentMethod method = AlignmentMethod::cpu) {
  AlignmentOptions options;
  options.method = method;
  options.rigidity = 0;
  options.insertBelow = 0.99;
  return options;
}

AlignmentOptions anythingGoes() {
  AlignmentOptions options = optionsWith();
  options.insertBelow = 2;
  options.insertGain = -2;
  options.varianceFloor = 0;
  options.instances = 4;
  return options;
}

std::size_t insert(Alignment& alignment, const AlignmentOptions& options, std::size_t most = 1000) {
  Positions began = alignment.position;
  return insertPoints(alignment, began, texelsOfAll(alignment), options, {most, 5 * kUnits, 7});
}

void addNoise(Planted& planted, double deviation) {
  if (deviation == 0) return;
  std::mt19937 random(33);
  std::normal_distribution<double> normal(0, deviation);
  for (Image8& picture : planted.pictures)
    for (auto& v : picture.values) v = std::uint8_t(std::clamp(v + normal(random), 0.0, 255.0));
}

// All pictures but the first are bent: in some squares the diagonal's middle is shifted, which the mesh cannot follow.
struct Ridges {
  static constexpr std::array<std::size_t, 4> kBent{0, 6, 9, 15};
  Planted planted;
  Alignment& alignment = planted.alignment;
  std::vector<glm::ivec2> off;  // shift of each picture, grid units

  explicit Ridges(int members = 2, double noise = 0) : planted(test::planted(members, kSide, kSquares, 0, 31)) {
    for (int i = 0; i < members; ++i) {
      alignment.position[std::size_t(i)] = alignment.position[0];
      off.push_back(i == 0 ? glm::ivec2(0) : glm::ivec2(i == 2 ? -470 : 500, i == 2 ? 130 : 60));
    }
    for (std::size_t i = 1; i < std::size_t(members); ++i) draw(i);
    addNoise(planted, noise);
  }

  void draw(std::size_t i) {
    const Alignment& a = alignment;
    for (std::size_t square = 0; square < a.triangles.size() / 2; ++square) {
      // The triangles (a, b, c) and (b, d, c) share the diagonal from b to c.
      const glm::uvec3 s = a.triangles[2 * square], t = a.triangles[2 * square + 1];
      const auto corner = [&](unsigned p) { return glm::dvec2(a.position[0][p]) / double(kUnits); };
      const glm::dvec2 middle = 0.5 * (corner(s.y) + corner(s.z));
      const bool bent = std::ranges::find(kBent, square) != kBent.end();
      const glm::dvec2 there = middle + (bent ? glm::dvec2(off[i]) / double(kUnits) : glm::dvec2(0));
      for (const auto& [from, to] :
           {std::pair(s.x, s.y), std::pair(t.x, t.y), std::pair(t.y, t.z), std::pair(s.z, s.x)})
        forTrianglePixels(corner(from), corner(to), there, kSide, kSide,
                          [&, one = from, two = to](int x, int y, const glm::dvec3& w) {
                            const glm::dvec3 colour =
                                bilinear(planted.pictures[0], w.x * corner(one) + w.y * corner(two) + w.z * middle);
                            for (int c = 0; c < 3; ++c)
                              planted.pictures[i].pixel(x, y)[std::size_t(c)] = std::uint8_t(colour[c] + 0.5);
                          });
    }
  }
};

// The right half of the second picture is nearer by 10 px of parallax, and hides what is on its left.
struct Step {
  static constexpr int kNearer = 10;
  Planted planted = test::planted(2, kSide, kSquares, 0, 34);
  Alignment& alignment = planted.alignment;

  Step() {
    alignment.position[1] = alignment.position[0];
    const auto edge = [](int y) { return kSide / 2 + (y - kSide / 2) / 4; };  // oblique: no mesh edge coincides
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        const int from = x >= edge(y) - kNearer ? std::min(x + kNearer, kSide - 1) : x;
        std::ranges::copy(planted.pictures[0].pixel(from, y), planted.pictures[1].pixel(x, y).begin());
      }
    for (std::size_t p = 0; p < alignment.position[0].size(); ++p) {
      const glm::ivec2 at = alignment.position[0][p] / kUnits;
      if (at.x >= edge(at.y)) alignment.position[1][p].x -= kNearer * kUnits;
    }
  }
};

// Checks that previous points keep their positions and that the mesh covers the same area without cracks or folds.
void checkWhole(const Alignment& before, const Alignment& now) {
  const std::size_t n = before.position[0].size(), added = now.inserted.size() - before.inserted.size();
  CHECK(borderOf(now.triangles) == borderOf(before.triangles));
  CHECK(now.unevaluated == before.unevaluated);
  std::set<unsigned> corners;
  for (const glm::uvec3& t : now.triangles) {
    CHECK(!foldedAnywhere(now.position, t));
    corners.insert({t.x, t.y, t.z});
  }
  for (std::size_t i = 0; i < now.position.size(); ++i) {
    const auto &was = before.position[i], &is = now.position[i];
    REQUIRE(is.size() == n + added);
    CHECK(std::equal(was.begin(), was.end(), is.begin()));
    std::int64_t area = 0;
    for (const glm::uvec3& t : now.triangles) area += shader::eccArea(is[t.x], is[t.y], is[t.z]);
    for (const glm::uvec3& t : before.triangles) area -= shader::eccArea(was[t.x], was[t.y], was[t.z]);
    CHECK(area == 0);
  }
  for (std::size_t k = 0; k < added; ++k) {
    CHECK(corners.contains(unsigned(n + k)));
    const InsertedPoint& point = now.inserted[before.inserted.size() + k];
    CHECK(point.weight.x + point.weight.y + point.weight.z == Approx(1));
    for (int c = 0; c < 3; ++c) CHECK(point.parent[c] < n + k);
  }
}

}  // namespace

TEST_CASE("points are inserted only on ridges that the mesh misses") {
  const int members = GENERATE(2, 3);
  const double noise = GENERATE(0.0, 6.0);
  const auto method = GENERATE(AlignmentMethod::cpu, AlignmentMethod::gradient);
  Ridges ridges(members, noise);
  const Alignment before = ridges.alignment;
  REQUIRE(insert(ridges.alignment, optionsWith(method)) == Ridges::kBent.size());
  checkWhole(before, ridges.alignment);
  const std::size_t n = before.position[0].size();
  CHECK(ridges.alignment.triangles.size() == before.triangles.size() + 2 * Ridges::kBent.size());
  std::set<unsigned> squares;
  for (std::size_t k = 0; k < Ridges::kBent.size(); ++k) {
    const InsertedPoint& point = ridges.alignment.inserted.at(k);
    CHECK(point.weight == glm::dvec3(0.5, 0.5, 0));
    for (const std::size_t square : Ridges::kBent) {
      const glm::uvec3 t = before.triangles[2 * square];
      if (std::minmax(point.parent.x, point.parent.y) == std::minmax(t.y, t.z)) squares.insert(unsigned(square));
    }
    for (std::size_t i = 1; i < before.position.size(); ++i) {
      const auto& at = ridges.alignment.position;
      const glm::dvec2 found(at[i][n + k] - at[0][n + k]);
      CHECK(glm::distance(found, glm::dvec2(ridges.off[i])) < 1.0 * kUnits);
    }
  }
  CHECK(squares == std::set<unsigned>(Ridges::kBent.begin(), Ridges::kBent.end()));
}

TEST_CASE("no point is inserted into a correct mesh or without texture") {
  SECTION("flat surface under noise, a tenth of a pixel off") {
    auto planted = test::planted(GENERATE(2, 3), kSide, GENERATE(2, 4), 0.1, 32);
    addNoise(planted, 6);
    AlignmentOptions options = optionsWith();
    options.rigidity = AlignmentOptions{}.rigidity;
    options.insertBelow = 1;
    CHECK(insert(planted.alignment, options) == 0);
  }
  SECTION("noise only, or constant images, with any gain accepted") {
    auto planted = test::planted(2, kSide, kSquares, 0, 25);
    for (Image8& picture : planted.pictures) picture = Image8(kSide, kSide, 3, 90);
    addNoise(planted, GENERATE(0.0, 3.0));
    AlignmentOptions options = anythingGoes();
    options.varianceFloor = 25;
    CHECK(insert(planted.alignment, options) == 0);
  }
  SECTION("triangles that are too small to split") {
    auto planted = test::planted(2, kSide, 20, 1, 26);  // 26 samples per triangle
    CHECK(insert(planted.alignment, anythingGoes()) == 0);
  }
  SECTION("triangles with an ECC above insertBelow") {
    Ridges ridges;
    AlignmentOptions options = optionsWith();
    options.insertBelow = -0.5;
    CHECK(insert(ridges.alignment, options) == 0);
  }
  SECTION("unmoved points that the guard refuses") {
    auto planted = test::planted(2, kSide, kSquares, 0, 37);
    for (Image8& picture : planted.pictures) picture = Image8(kSide, kSide, 3, 90);
    AlignmentOptions options = anythingGoes();
    REQUIRE(insert(planted.alignment, options) > 0);
    options.guard = [](std::uint32_t, std::span<const glm::ivec2>) { return false; };
    const std::size_t before = planted.alignment.inserted.size();
    CHECK(insert(planted.alignment, options) == 0);
    CHECK(planted.alignment.inserted.size() == before);
  }
  SECTION("points that the guard refuses") {
    Ridges ridges;
    AlignmentOptions options = optionsWith();
    std::set<unsigned> asked;
    options.guard = [&](std::uint32_t point, std::span<const glm::ivec2> match) {
      CHECK(match.size() == 2);
      asked.insert(point);
      return false;
    };
    CHECK(insert(ridges.alignment, options) == 0);
    CHECK(asked.size() >= Ridges::kBent.size());
    CHECK(*asked.begin() >= ridges.alignment.position[0].size());
  }
}

TEST_CASE("an edge that a third triangle shares is not split") {
  Ridges ridges;
  const Alignment before = ridges.alignment;
  for (const std::size_t square : Ridges::kBent) {
    const glm::uvec3 t = before.triangles[2 * square];
    ridges.alignment.unevaluated.emplace_back(t.y, t.z, t.x);
  }
  insert(ridges.alignment, optionsWith());
  for (const InsertedPoint& point : ridges.alignment.inserted)
    for (const std::size_t square : Ridges::kBent) {
      const glm::uvec3 t = before.triangles[2 * square];
      CHECK(!(point.weight.z == 0 && std::minmax(point.parent.x, point.parent.y) == std::minmax(t.y, t.z)));
    }
}

TEST_CASE("the mesh stays consistent with many insertions and any number of threads") {
  const auto grown = [](int threads, bool kept) {
    auto planted = test::planted(3, kSide, kSquares, 4, 35);
    Alignment& a = planted.alignment;
    a.fixed.assign(a.position[0].size(), 0);
    a.epipolar.assign(3, std::vector<glm::vec2>(a.fixed.size(), {0.6f, 0.8f}));
    if (kept) {
      for (const std::size_t t : {11, 9, 3}) {  // neighbours of triangle 10, which becomes an island in a hole
        a.unevaluated.push_back(a.triangles[t]);
        a.triangles.erase(a.triangles.begin() + std::ptrdiff_t(t));
      }
    }
    const Alignment before = a;
    AlignmentOptions options = anythingGoes();
    options.threads = threads;
    CHECK(insert(a, options) > 8);
    checkWhole(before, a);
    CHECK(a.fixed.size() == a.position[0].size());
    for (const auto& along : a.epipolar) {
      REQUIRE(along.size() == a.fixed.size());
      CHECK(double(along.back().x) == Approx(0.6));
    }
    std::size_t middles = 0;
    for (const InsertedPoint& point : a.inserted) middles += point.weight.z > 0;
    CHECK(middles == (kept ? 1 : 0));  // points inside a triangle: the island's edges are not split
    return std::pair(a.position, a.triangles);
  };
  const bool kept = GENERATE(false, true);
  const auto once = grown(1, kept);
  CHECK(once == grown(1, kept));
  CHECK(once == grown(3, kept));
}

TEST_CASE("at most insertShare of the points are inserted, the largest gains first") {
  Ridges all, some;
  insert(all.alignment, optionsWith());
  const std::size_t most = GENERATE(0, 1, 3);
  REQUIRE(insert(some.alignment, optionsWith(), most) == most);
  REQUIRE(all.alignment.inserted.size() >= most);
  for (std::size_t k = 0; k < most; ++k) CHECK(some.alignment.inserted[k].parent == all.alignment.inserted[k].parent);
}

// A triangle is so thin in one picture that rounding a new point to the grid decides if the triangle folds over.
TEST_CASE("splitting triangles that are thin in one image folds no part over", "[N4][P8]") {
  const Image8 grey(80, 80, 3, 90);
  std::mt19937 random(36);
  const auto upTo = [&](int most) { return int(random() % unsigned(most + 1)); };
  const AlignmentOptions options = [] {
    AlignmentOptions o = anythingGoes();
    o.threads = 1;
    o.instances = 2;
    return o;
  }();
  int added = 0, refused = 0;
  for (int round = 0; round < 4000; ++round) {
    Alignment a;
    a.pictures = {&grey, &grey};
    const int x = 1000 + upTo(200), wide = 7000 + upTo(1000), y = 2000 + upTo(200), thin = upTo(3);
    a.position = {{{x, y}, {x + wide, y}, {x + wide / 2, y + 6500}, {x + wide / 2, y - 1900}},
                  {{x, y + upTo(3)}, {x + wide, y + upTo(3)}, {x + wide / 2, y + 1 + thin}, {x + wide / 3, y - thin}}};
    a.triangles = {{0, 1, 2}, {1, 0, 3}};
    if (foldedAnywhere(a.position, a.triangles[0]) || foldedAnywhere(a.position, a.triangles[1])) continue;
    const Alignment before = a;
    const std::size_t n = insert(a, options);
    (n > 0 ? added : refused)++;
    for (const glm::uvec3& t : a.triangles)
      if (foldedAnywhere(a.position, t)) FAIL_CHECK("folded in round " << round);
  }
  CAPTURE(added, refused);
  CHECK(added > 100);
  CHECK(refused > 20);
}

TEST_CASE("the optimiser inserts points between cycles with insertPoints and raises the ECC") {
  AlignmentOptions options = optionsWith(GENERATE(AlignmentMethod::cpu, AlignmentMethod::gradient));
  options.levels = options.method == AlignmentMethod::gradient ? 2 : 1;
  options.rigidity = 1;
  options.insertShare = GENERATE(0.5, 0.1);
  const auto run = [&](bool inserts) {
    Step step;
    const Alignment before = step.alignment;
    const std::size_t n = before.position[0].size();
    step.alignment.epipolar.assign(2, std::vector<glm::vec2>(n));
    step.alignment.fixed.assign(n, 0);
    options.insertPoints = inserts;
    const AlignmentSummary summary = align(step.alignment, options);
    const Alignment& now = step.alignment;
    std::size_t counted = 0;
    for (std::size_t c = 0; c < summary.bestCycle; ++c) counted += summary.cycles[c].inserted;
    CHECK(summary.insertions == counted);
    CHECK(now.inserted.size() == counted);
    CHECK(now.position[0].size() == n + counted);
    CHECK(double(counted) <= options.insertShare * double(n));
    CHECK(summary.finalEcc == summary.cycles.at(summary.bestCycle - 1).ecc);
    REQUIRE(summary.initialStarEcc.size() == n + counted);
    REQUIRE(summary.finalStarEcc.size() == n + counted);
    double mean = 0;
    for (std::size_t p = 0; p < n + counted; ++p) {
      CHECK(std::isnan(summary.initialStarEcc[p]) == (p >= n));
      if (p < n) mean += double(summary.finalStarEcc[p]) / double(n);
    }
    CHECK(summary.finalEcc == Approx(mean).epsilon(1e-5));
    CHECK(borderOf(now.triangles) == borderOf(before.triangles));
    for (const glm::uvec3& t : now.triangles) CHECK(!foldedAnywhere(now.position, t));
    return summary;
  };
  const AlignmentSummary without = run(false), with = run(true), again = run(true);
  CAPTURE(without.initialEcc, without.finalEcc, with.finalEcc, with.insertions);
  CHECK(without.insertions == 0);
  CHECK(with.insertions >= 2);
  CHECK(with.finalEcc > without.finalEcc + 0.002);
  CHECK(again.finalEcc == with.finalEcc);
}

TEST_CASE("cancelling removes inserted points, and options out of range are reported") {
  Ridges ridges;
  AlignmentOptions options = optionsWith();
  options.insertPoints = true;
  std::size_t cycles = 0;
  const auto untilSecond = [&](const Progress& p) { return (cycles = p.done) == 0; };
  CHECK(errorOf([&] { align(ridges.alignment, options, nullptr, untilSecond); }).code() == ErrorCode::cancelled);
  CHECK(cycles == 1);
  CHECK(ridges.alignment.inserted.empty());
  CHECK(ridges.alignment.position[0].size() == 25);
  CHECK(ridges.alignment.triangles.size() == 32);
  const auto fault = [&](auto&& change) {
    AlignmentOptions wrong = options;
    change(wrong);
    return firstInvalidOption(wrong);
  };
  CHECK_THAT(fault([](auto& o) { o.insertGain = -0.1; }), Catch::Contains("insertGain") && Catch::Contains("-0.1"));
  CHECK_THAT(fault([](auto& o) { o.insertBelow = 1.5; }), Catch::Contains("insertBelow") && Catch::Contains("1.5"));
  CHECK_THAT(fault([](auto& o) { o.insertShare = 5; }),
             Catch::Contains("insertShare") && Catch::Contains("5") && Catch::Contains("4"));
}
