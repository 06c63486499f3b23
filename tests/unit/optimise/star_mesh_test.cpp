// SPDX-License-Identifier: Apache-2.0
// Star meshes: reach of candidates, invariants, and refused input.
#include "optimise/star_mesh.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "shared/ecc.h"
#include "support/error_of.h"
#include "support/planted.h"

using namespace ibr;

namespace {

// n points around a centre, some almost collinear with neighbours, some duplicated: slivers and fans.
Alignment fan(std::mt19937& random, int members, const Image8& picture) {
  Alignment a;
  const int n = 3 + int(random() % 7);
  for (int i = 0; i < members; ++i) {
    a.pictures.push_back(&picture);
    auto& at = a.position.emplace_back();
    const glm::dvec2 centre(5000 + double(random() % 2000), 5000 + double(random() % 2000));
    at.push_back(glm::ivec2(centre));
    const double squeeze = std::pow(2.0, -double(random() % 9));
    for (int k = 0; k < n; ++k) {
      const double angle = 6.28318 * (k + 0.8 * double(random() % 1000) / 1000) / n, r = 20 + double(random() % 4000);
      at.push_back(glm::ivec2(centre + r * glm::dvec2(std::cos(angle), squeeze * std::sin(angle))));
    }
  }
  for (int k = 0; k < n; ++k) {
    const glm::uvec3 t(0, 1 + k, 1 + (k + 1) % n);
    bool isUnfolded = true;
    for (const auto& at : a.position) isUnfolded = isUnfolded && shader::eccArea(at[t.x], at[t.y], at[t.z]) > 0;
    (isUnfolded ? a.triangles : a.unevaluated).push_back(t);
  }
  return a;
}

__extension__ using Int128 = __int128;

// Twice the area in 128 bits: exact at any position, and independent of the tested code.
Int128 exactArea(glm::ivec2 a, glm::ivec2 b, glm::ivec2 c) {
  return (Int128(b.x) - a.x) * (Int128(c.y) - a.y) - (Int128(b.y) - a.y) * (Int128(c.x) - a.x);
}

bool foldsSomewhere(const Positions& at, const glm::uvec3& t) {
  const auto folded = [&](auto&& position) { return exactArea(position(t.x), position(t.y), position(t.z)) <= 0; };
  glm::ivec2 none(0);
  bool any = folded([&](std::uint32_t p) {
    glm::ivec2 sum = none;
    for (const auto& member : at) sum += member[p];
    return sum;
  });
  for (std::size_t i = 0; i < at.size(); ++i) {
    any = any || folded([&](std::uint32_t p) { return at[i][p]; });
    for (std::size_t k = 0; k < i; ++k) any = any || folded([&](std::uint32_t p) { return at[i][p] + at[k][p]; });
  }
  return any;
}

}  // namespace

TEST_CASE("none of a million candidates folds a triangle over", "[N4][T8][P8]") {
  std::mt19937 random(17);
  const Image8 picture(128, 128, 3);
  std::size_t candidates = 0, moved = 0;
  while (candidates < 1000000) {
    const Alignment a = fan(random, 2 + int(random() % 3), picture);
    const StarMesh mesh = starMeshOf(a);
    for (std::size_t member = 0; member < a.position.size(); ++member) {
      const int reach = maxMove(mesh, a.position, 0, member, 640);
      for (std::uint32_t m = 1; m < 64; ++m) {
        ++candidates;
        const glm::ivec2 offset = candidateOffset(mesh, a.position, 0, member, reach, std::uint32_t(random()), m);
        Positions at = a.position;
        at[member][0] += offset;
        if (!fits(mesh, a.position, 0, member, offset)) {
          // Within reach, only triangles in `unevaluated` may forbid an offset.
          for (const glm::uvec3& t : a.triangles)
            if (!foldsSomewhere(a.position, t)) REQUIRE_FALSE(foldsSomewhere(at, t));
          continue;
        }
        moved += offset != glm::ivec2(0);
        for (const glm::uvec3& t : a.triangles)
          if (!foldsSomewhere(a.position, t)) REQUIRE_FALSE(foldsSomewhere(at, t));
        for (const glm::uvec3& t : a.unevaluated)
          for (std::size_t i = 0; i < at.size(); ++i)
            if (exactArea(a.position[i][t.x], a.position[i][t.y], a.position[i][t.z]) > 0)
              REQUIRE(exactArea(at[i][t.x], at[i][t.y], at[i][t.z]) > 0);
      }
    }
  }
  CHECK(moved > 100000);
}

TEST_CASE("points of the border slide along the border, and corners of a hole do not move") {
  const test::Planted planted = test::planted(2, 96, 4, 0.0, 1);
  const StarMesh mesh = starMeshOf(planted.alignment);
  const Positions& at = planted.alignment.position;
  const auto index = [](int x, int y) { return std::uint32_t(y * 5 + x); };
  CHECK(mesh.border[index(2, 2)] == BorderKind::interior);
  CHECK(mesh.border[index(2, 0)] == BorderKind::slides);
  for (std::uint32_t m = 1; m < 50; ++m) {
    const glm::ivec2 offset = candidateOffset(mesh, at, index(2, 0), 1, 300, 8, m);
    CHECK(offset.y == 0);  // the upper border is horizontal
    CHECK(std::abs(offset.x) <= 300);
  }
  Alignment crossed = planted.alignment;  // two opposite squares lose their triangles: a point has two borders
  std::erase_if(crossed.triangles, [&](const glm::uvec3& t) {
    const auto inSquare = [&](int x, int y) {
      for (int c = 0; c < 3; ++c) {
        const int px = int(t[c]) % 5, py = int(t[c]) / 5;
        if (px < x || px > x + 1 || py < y || py > y + 1) return false;
      }
      return true;
    };
    return inSquare(1, 1) || inSquare(2, 2);
  });
  CHECK(starMeshOf(crossed).border[index(2, 2)] == BorderKind::fixed);
}

TEST_CASE("points of a class share no triangle, and every movable point is in a class") {
  const test::Planted planted = test::planted(3, 128, 8, 2.0, 2);
  const StarMesh mesh = starMeshOf(planted.alignment);
  std::vector<int> classOf(mesh.vertexCount(), -1);
  for (std::size_t c = 0; c + 1 < mesh.colours.first.size(); ++c)
    for (const std::uint32_t p : mesh.colours[c]) classOf[p] = int(c);
  for (std::size_t p = 0; p < mesh.vertexCount(); ++p) CHECK((classOf[p] < 0) == (mesh.border[p] == BorderKind::fixed));
  for (const glm::uvec3& t : planted.alignment.triangles) {
    CHECK(classOf[t.x] != classOf[t.y]);
    CHECK(classOf[t.y] != classOf[t.z]);
    CHECK(classOf[t.z] != classOf[t.x]);
  }
}

TEST_CASE("invalid alignments are refused by field") {
  const test::Planted planted = test::planted(2, 64, 2, 0.0, 3);
  const auto faultOf = [&](auto&& spoil) {
    Alignment a = planted.alignment;
    spoil(a);
    return std::string(test::errorOf([&] { starMeshOf(a); }).what());
  };
  CHECK_THAT(faultOf([](Alignment& a) { a.pictures.resize(1); }),
             Catch::Contains("alignment") && Catch::Contains("pictures") && Catch::Contains("1"));
  CHECK_THAT(faultOf([](Alignment& a) { a.position.pop_back(); }),
             Catch::Contains("alignment.position") && Catch::Contains("1") && Catch::Contains("2"));
  CHECK_THAT(faultOf([](Alignment& a) { a.position[1].pop_back(); }),
             Catch::Contains("alignment.position[1]") && Catch::Contains("8") && Catch::Contains("9"));
  CHECK_THAT(faultOf([](Alignment& a) { a.position[0][4].x = -1; }), Catch::Contains("alignment.position[0][4]") &&
                                                                         Catch::Contains("(-1, 4096)/128 px") &&
                                                                         Catch::Contains("64×64 px"));
  CHECK_THAT(faultOf([](Alignment& a) { a.triangles[2].y = 9; }),
             Catch::Contains("alignment.triangles[2]") && Catch::Contains("9"));
  CHECK_THAT(faultOf([](Alignment& a) { std::swap(a.triangles[2].x, a.triangles[2].y); }),
             Catch::Contains("alignment.triangles[2]") && Catch::Contains("folded"));
  CHECK_THAT(faultOf([](Alignment& a) { a.fixed = {1}; }),
             Catch::Contains("alignment.fixed") && Catch::Contains("1") && Catch::Contains("9"));
  const Image8 grey(64, 64, 1);
  CHECK_THAT(faultOf([&](Alignment& a) { a.pictures[1] = &grey; }),
             Catch::Contains("alignment.pictures[1]") && Catch::Contains("RGB"));
}

TEST_CASE("positions are exact in single precision up to the largest image", "[N4]") {
  constexpr int kLargest = 16384 * kAlignmentUnitsPerPixel;
  for (int i = 0; i <= kLargest; i += 61) {
    const float stored = float(i) / kAlignmentUnitsPerPixel;
    REQUIRE(double(stored) * kAlignmentUnitsPerPixel == i);
  }
  CHECK(double(float(kLargest - 1) / kAlignmentUnitsPerPixel) * kAlignmentUnitsPerPixel == kLargest - 1);
}
