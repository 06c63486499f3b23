// SPDX-License-Identifier: Apache-2.0
#include "reference/alignment/alignment_reference.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>
#include <set>
#include <utility>

using namespace ibr;
using namespace ibr::reference;

namespace {

std::set<std::pair<int, int>> inRows(int firstRow, int rows, int firstColumn, int columns) {
  std::set<std::pair<int, int>> pixels;
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) pixels.insert({firstColumn + i, firstRow + j});
  return pixels;
}

// Adds the pixels of a triangle. Returns false if one of them was present already.
bool collect(std::set<std::pair<int, int>>& pixels, glm::ivec2 a, glm::ivec2 b, glm::ivec2 c) {
  bool once = true;
  for (const glm::ivec2& p : coveredPixels(a, b, c)) once = pixels.insert({p.x, p.y}).second && once;
  return once;
}

std::set<std::pair<int, int>> square(glm::ivec2 corner, int side, bool otherDiagonal) {
  const glm::ivec2 a = corner, b = corner + glm::ivec2(side, 0), c = corner + side, d = corner + glm::ivec2(0, side);
  std::set<std::pair<int, int>> pixels;
  if (otherDiagonal) {
    CHECK(collect(pixels, a, b, d));
    CHECK(collect(pixels, b, c, d));
  } else {
    CHECK(collect(pixels, a, b, c));
    CHECK(collect(pixels, a, c, d));
  }
  return pixels;
}

// Even-odd rule along the row. Edges hold for rows [upper end, lower end); crossings at or left of the centre count.
bool insidePolygon(const std::vector<glm::ivec2>& ring, std::int64_t x, std::int64_t y) {
  bool inside = false;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    glm::i64vec2 a = ring[k], b = ring[(k + 1) % ring.size()];
    if (a.y > b.y) std::swap(a, b);
    if (a.y <= y && y < b.y && a.x * (b.y - a.y) + (b.x - a.x) * (y - a.y) <= x * (b.y - a.y)) inside = !inside;
  }
  return inside;
}

std::size_t pixelsInside(const std::vector<glm::ivec2>& ring) {
  std::size_t count = 0;
  for (int j = 0; j < 64; ++j)
    for (int i = 0; i < 64; ++i) count += insidePolygon(ring, 256 * i + 128, 256 * j + 128);
  return count;
}

std::int64_t area(glm::i64vec2 a, glm::i64vec2 b, glm::i64vec2 c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

struct Fan {
  glm::ivec2 hub;
  std::vector<glm::ivec2> ring;  // clockwise in the image
};

// Random star. Every third kind lies on pixel centres where possible, every second is flat. Empty if a triangle folds.
Fan randomFan(std::mt19937& random, int kind) {
  const auto whole = [&](int most) { return int(random() % std::uint32_t(most)); };
  const int grid = kind % 3 == 0 ? 128 : 1;
  const double flat = kind % 2 ? 0.02 : 1.0;
  Fan fan{{(32 * 256 + whole(256)) / grid * grid, (32 * 256 + whole(256)) / grid * grid}, {}};
  const int corners = 3 + whole(6);
  for (int k = 0; k < corners; ++k) {
    const double angle = 6.283185307 * (k + 0.7 * whole(1000) / 1000.0) / corners, radius = 300 + whole(7000);
    const glm::dvec2 way(radius * std::cos(angle), radius * flat * std::sin(angle));
    const glm::dvec2 turned = kind % 4 == 1 ? glm::dvec2(0.6 * way.x - 0.8 * way.y, 0.8 * way.x + 0.6 * way.y) : way;
    fan.ring.push_back((fan.hub + glm::ivec2(turned)) / grid * grid);
  }
  for (std::size_t k = 0; k < fan.ring.size(); ++k)
    if (area(fan.hub, fan.ring[k], fan.ring[(k + 1) % fan.ring.size()]) <= 0) return {};
  return fan;
}

Image8 texture(std::uint32_t seed, int width = 48, int height = 40) {
  std::mt19937 random(seed);
  Image8 picture(width, height, 3);
  for (auto& v : picture.values) v = std::uint8_t(40 + random() % 100);
  return picture;
}

// Meshes with point 4 in the middle of a square of 20 px whose corner is at (8, 8) px.
AlignedPictures squares(std::vector<const Image8*> pictures) {
  const std::vector<glm::ivec2> points{{1024, 1024}, {3584, 1024}, {3584, 3584}, {1024, 3584}, {2304, 2304}};
  AlignedPictures mesh{std::move(pictures), {}, {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}};
  mesh.position.assign(mesh.pictures.size(), points);
  return mesh;
}

void shift(AlignedPictures& mesh, std::size_t member, glm::ivec2 by) {
  for (glm::ivec2& p : mesh.position[member]) p += by;
}

}  // namespace

TEST_CASE("a square of two triangles covers pixel centres by the top-left rule") {
  for (const bool otherDiagonal : {false, true}) {
    CHECK(square({2560, 2560}, 2560, otherDiagonal) == inRows(10, 10, 10, 10));
    CHECK(square({2560 + 128, 2560 + 128}, 2560, otherDiagonal) == inRows(10, 10, 10, 10));
    CHECK(square({2560 + 129, 2560 + 127}, 2560, otherDiagonal) == inRows(10, 10, 11, 10));
    CHECK(square({2560 + 128, 2560 + 128}, 1, otherDiagonal) == inRows(10, 1, 10, 1));
    CHECK(square({2560 + 129, 2560 + 128}, 255, otherDiagonal).empty());
  }
  CHECK(coveredPixels({0, 0}, {0, 2560}, {2560, 2560}).empty());  // opposite orientation
  CHECK(coveredPixels({0, 0}, {2560, 2560}, {5120, 5120}).empty());
  CHECK(coveredPixels({-256, -256}, {0, -256}, {-256, 0}).empty());
  CHECK(coveredPixels({-300, -300}, {100, -300}, {-300, 100}) == std::vector<glm::ivec2>{{-1, -1}});
}

TEST_CASE("triangle fans and needles cover each pixel of their polygon exactly once") {
  std::mt19937 random(1);
  int fans = 0;
  std::size_t pixels = 0;
  for (int kind = 0; fans < 1000; ++kind) {
    const Fan fan = randomFan(random, kind);
    if (fan.ring.empty()) continue;
    ++fans;
    std::set<std::pair<int, int>> covered;
    bool once = true;
    for (std::size_t k = 0; k < fan.ring.size(); ++k)
      once = collect(covered, fan.hub, fan.ring[k], fan.ring[(k + 1) % fan.ring.size()]) && once;
    REQUIRE(once);
    REQUIRE(covered.size() == pixelsInside(fan.ring));
    pixels += covered.size();
  }
  CHECK(pixels > 100'000);
}

TEST_CASE("a sliver covers at most area, perimeter and one pixel together", "[N1][T2]") {
  std::mt19937 random(2);
  double largest = 0;
  for (int i = 0; i < 2000; ++i) {
    const glm::ivec2 a(random() % 8192, random() % 8192), b(random() % 8192, random() % 8192);
    const glm::ivec2 c = (a + b) / 2 + glm::ivec2(int(random() % 41) - 20, int(random() % 41) - 20);
    const double size = double(area(a, b, c)) / (2 * 65536.0);
    if (size <= 0) continue;
    const auto length = [](glm::ivec2 p, glm::ivec2 q) { return glm::distance(glm::dvec2(p), glm::dvec2(q)) / 256; };
    const double count = double(coveredPixels(a, b, c).size());
    REQUIRE(count <= size + length(a, b) + length(b, c) + length(c, a) + 1);
    largest = std::max(largest, count / size);
  }
  CHECK(largest > 10);
}

TEST_CASE("equal images have ECC 1, and each pixel is a sample") {
  const Image8 picture = texture(1);
  for (std::size_t d : {2, 3, 4}) {
    const StarEcc star = starEcc(squares(std::vector<const Image8*>(d, &picture)), 4, 1);
    REQUIRE(star.targets.size() == d - 1);
    CHECK(star.targets[0].member == 0);
    CHECK(star.targets.back().member == (d == 2 ? 0 : d - 1));
    for (const StarTarget& target : star.targets) {
      CHECK(target.pixels == 400);
      double sum = 0;
      for (int y = 8; y < 28; ++y)
        for (int x = 8; x < 28; ++x) sum += picture.pixel(x, y)[1];
      CHECK(target.x[1] == Approx(sum).epsilon(1e-13));
      CHECK(target.xy[2] == Approx(target.xx[2]).epsilon(1e-13));
    }
    CHECK(star.channels.value == Approx(1).epsilon(1e-13));
    CHECK(star.concatenated.value == Approx(1).epsilon(1e-13));
  }
}

TEST_CASE("photographs are sampled at their own corners, between texels and beyond the border") {
  Image8 ramp(48, 40, 3);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 48; ++x) {
      const auto p = ramp.pixel(x, y);
      p[0] = std::uint8_t(3 * x), p[1] = std::uint8_t(5 * y), p[2] = std::uint8_t(2 * x + y);
    }
  AlignedPictures mesh = squares({&ramp, &ramp});
  shift(mesh, 1, {3 * 128 + 32, 64});
  const StarTarget target = starEcc(mesh, 4, 0).targets[0];
  CHECK(target.pixels == 400);  // the mean starts at (9.625, 8.25)
  CHECK(target.y[0] - target.x[0] == Approx(400 * 3 * 3.25).epsilon(1e-12));
  CHECK(target.y[1] - target.x[1] == Approx(400 * 5 * 0.5).epsilon(1e-12));
  CHECK(target.y[2] - target.x[2] == Approx(400 * (2 * 3.25 + 0.5)).epsilon(1e-12));
  // Pixel centres of the mean are 10.5 to 29.5, 1.625 px further than in the source.
  CHECK(target.x[0] == Approx(400 * 3 * (20.0 - 1.625 - 0.5)).epsilon(1e-12));

  const Image8 picture = texture(1);
  AlignedPictures apart = squares({&picture, &picture});
  shift(apart, 1, {64, 0});  // a quarter of a pixel to each side of the mean
  const StarTarget between = starEcc(apart, 4, 0).targets[0];
  double left = 0, right = 0;
  for (int y = 8; y < 28; ++y)
    for (int x = 8; x < 28; ++x) {
      left += 0.25 * picture.pixel(x - 1, y)[0] + 0.75 * picture.pixel(x, y)[0];
      right += 0.75 * picture.pixel(x, y)[0] + 0.25 * picture.pixel(x + 1, y)[0];
    }
  CHECK(between.x[0] == Approx(left).epsilon(1e-13));
  CHECK(between.y[0] == Approx(right).epsilon(1e-13));

  AlignedPictures border{{&picture, &picture}, {}, {{0, 1, 2}}};
  border.position = {{{0, 0}, {64, -64}, {-64, 64}}, {{192, 192}, {256, 192}, {192, 256}}};
  const StarEcc corner = starEcc(border, 0, 0, {-64, -64});  // the mean triangle is (128, 128), (320, 128), (128, 320)
  REQUIRE(corner.targets[0].pixels == 1);
  CHECK(corner.targets[0].x[0] == picture.pixel(0, 0)[0]);  // sampled at (-½, -½)
  CHECK(corner.targets[0].y[0] == picture.pixel(1, 1)[0]);
  for (const StarEcc& one : {corner, starEcc(border, 0, 0, {-64, -64}, 25)}) {
    CHECK_FALSE(one.channels.defined);
    CHECK_FALSE(one.concatenated.defined);
  }
}

TEST_CASE("a candidate's ECC equals the ECC of the mesh with the moved point") {
  const Image8 a = texture(1), b = texture(2), c = texture(3);
  AlignedPictures mesh = squares({&a, &b, &c});
  shift(mesh, 2, {77, -31});
  const StarEcc candidate = starEcc(mesh, 4, 1, {130, -97}, 25);
  mesh.position[1][4] += glm::ivec2(130, -97);
  const StarEcc moved = starEcc(mesh, 4, 1, {0, 0}, 25), still = starEcc(squares({&a, &b, &c}), 4, 1, {0, 0}, 25);
  CHECK(candidate.channels.value == moved.channels.value);
  CHECK(candidate.channels.value != still.channels.value);
  CHECK(candidate.targets[1].pixels == moved.targets[1].pixels);
  CHECK(starEcc(mesh, 0, 1).targets[0].pixels < moved.targets[0].pixels);  // two of the four triangles
}

TEST_CASE("whole-pixel shifts give the ECC of the shifted pixels, in both definitions") {
  Image8 a = texture(1), b(48, 40, 3), c = texture(3);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 48; ++x)
      for (int k = 0; k < 3; ++k)
        b.pixel(x, y)[k] = std::uint8_t((a.pixel(std::max(x - 4, 0), y)[k] + c.pixel(x, y)[k]) / 2 + 20 * k);
  AlignedPictures mesh = squares({&a, &b, &c});
  shift(mesh, 1, {4 * 128, 0});
  std::vector<EccMoments> sums(6);
  for (int y = 8; y < 28; ++y)
    for (int x = 8; x < 28; ++x)
      for (int k = 0; k < 3; ++k) {
        sums[k].add(a.pixel(x, y)[k], b.pixel(x + 4, y)[k]);
        sums[3 + k].add(a.pixel(x, y)[k], c.pixel(x, y)[k]);
      }
  for (const int floor : {0, 25}) {
    const StarEcc star = starEcc(mesh, 4, 0, {0, 0}, floor);
    CHECK(star.channels.value == Approx(ecc(sums, EccDefinition::channels, floor).value).margin(1e-13));
    CHECK(star.concatenated.value == Approx(ecc(sums, EccDefinition::concatenated).value).margin(1e-13));
    CHECK(star.channels.value > 0.2);
  }
  const Image8 flat(48, 40, 3, 99);
  CHECK_FALSE(starEcc(squares({&flat, &a}), 4, 0).channels.defined);
  CHECK_FALSE(starEcc(squares({&flat, &a}), 4, 0, {5, 9}, 25).concatenated.defined);
  CHECK(starEcc(squares({&flat, &flat}), 4, 0, {5, 9}, 25).channels.value == 1.0);
}
