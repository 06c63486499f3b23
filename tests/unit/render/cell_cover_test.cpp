// SPDX-License-Identifier: Apache-2.0
// Choice of the cells that cover a view best (render/plan/cell_cover.h, cell_choice.h).
#include "render/plan/cell_cover.h"

#include <algorithm>
#include <bit>
#include <catch2/catch.hpp>
#include <functional>
#include <glm/gtc/quaternion.hpp>
#include <numbers>
#include <random>

#include "support/without_avx2.h"

using namespace ibr;

namespace {

Camera viewAt(glm::dvec3 position, glm::dquat rotation = {1, 0, 0, 0}) {
  return {pinholeFromFov(640, 480, std::numbers::pi / 3), {position, rotation}};
}

// Bounds with points all over a camera's view, at this inverse distance along the axis; 0: at infinity.
CellBounds seenFrom(const Camera& camera, double inverseDistance) {
  CellBounds bounds;
  const Intrinsics& k = camera.intrinsics;
  for (int y = 0; y < 12; ++y)
    for (int x = 0; x < 16; ++x) {
      const glm::dvec2 pixel((x + 0.5) * k.width / 16, (y + 0.5) * k.height / 12);
      glm::dvec3 ray = unproject(k, pixel);
      ray /= -ray.z;
      bounds.surface.emplace_back(glm::vec3(camera.pose.rotation * ray), float(inverseDistance));
    }
  return bounds;
}

CellCover tiles(std::initializer_list<std::size_t> set) {
  CellCover cover;
  for (const std::size_t tile : set) cover.set(tile);
  return cover;
}

std::vector<std::size_t> chosenOf(const std::vector<CellCover>& covers, const std::vector<double>& worth, double behind,
                                  std::size_t most, std::size_t forced) {
  std::vector<bool> asked(covers.size());
  const auto cover = [&](std::size_t c) {
    CHECK_FALSE(asked[c]);
    asked[c] = true;
    return covers[c];
  };
  const auto chosen = coveringCells(std::ref(cover), tilesOfViews(2), worth, behind, most, forced);
  return {chosen.begin(), chosen.end()};
}

}  // namespace

TEST_CASE("a cell covers the tiles of its visible points in each view") {
  const Camera camera = viewAt({3, 1, -2});
  const CellBounds bounds = seenFrom(camera, 0.2);
  const glm::dvec3 place = camera.pose.position;
  CHECK(coverOf(bounds, place, std::vector{camera}).count() == kCoverTiles / 2);
  CHECK(coverOf(bounds, place, std::vector{camera, camera}).count() == kCoverTiles);
  // Turned by half of the field of view: the cell covers only the half of the picture on its side.
  const Camera aside = viewAt(place, glm::angleAxis(std::numbers::pi / 6, glm::dvec3(0, 1, 0)));
  const std::size_t half = coverOf(bounds, place, std::vector{aside}).count();
  CHECK(half >= kCoverTiles / 4);
  CHECK(half < kCoverTiles / 2);
  const Camera away = viewAt(place, glm::angleAxis(std::numbers::pi, glm::dvec3(0, 1, 0)));
  CHECK(coverOf(bounds, place, std::vector{away}).none());
  CHECK(coverOf({}, place, std::vector{camera}).none());
}

TEST_CASE("covers are equal in both versions of the inner loop") {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<float> unit(-1, 1);
  CellBounds bounds;
  for (int p = 0; p < 300; ++p)  // more than a chunk, and a part of one
    bounds.surface.emplace_back(unit(random), unit(random), unit(random), 0.5f + 0.5f * unit(random));
  for (int repeat = 0; repeat < 100; ++repeat) {
    const std::vector views{viewAt({unit(random), unit(random), unit(random)},
                                   glm::angleAxis(3 * double(unit(random)), glm::dvec3(0, 1, 0)))};
    const auto compute = [&] {
      return coverOf({.surface = {bounds.surface.begin(), bounds.surface.begin() + 3 * repeat}}, {0.1, 0.2, 0.3},
                     views);
    };
    CHECK(test::withoutAvx2(compute) == compute());
  }
}

TEST_CASE("content at infinity is covered from every position, far from the origin too") {
  const Camera camera = viewAt({0, 0, 0});
  const CellBounds sky = seenFrom(camera, 0), wall = seenFrom(camera, 0.1);
  for (const double far : {0.0, 1e3, 1e9, 1e12}) {
    const Camera moved = viewAt({far, 0, 0});
    CHECK(coverOf(sky, {0, 0, 0}, std::vector{moved}).count() == kCoverTiles / 2);
    CHECK(coverOf(wall, {far, 0, 0}, std::vector{moved}).count() == kCoverTiles / 2);  // the cell's world moved along
    if (far > 0) CHECK(coverOf(wall, {0, 0, 0}, std::vector{moved}).none());
  }
}

TEST_CASE("cells are chosen by their added coverage, not by their own value") {
  // 0 and 1 cover the same four tiles and are worth most; 2 covers another tile.
  const std::vector<CellCover> covers{tiles({0, 1, 2, 3}), tiles({0, 1, 2, 3}), tiles({4})};
  const std::vector<double> worth{1, 0.9, 0.3};
  CHECK(chosenOf(covers, worth, 0, 2, 3) == std::vector<std::size_t>{0, 2});
  CHECK(chosenOf(covers, worth, 0, 1, 3) == std::vector<std::size_t>{0});
  CHECK(chosenOf(covers, worth, 0, 0, 3).empty());
  CHECK(chosenOf(covers, worth, 0, 3, 3) == std::vector<std::size_t>{0, 1, 2});
  CHECK(chosenOf(covers, worth, 0, 64, 3).size() == 3);
  CHECK(chosenOf(covers, worth, 0, 1, 1) == std::vector<std::size_t>{1});  // the forced cell
  CHECK(chosenOf({}, {}, 0, 4, 0).empty());
  // The background, worth 0.5 and then 2, is worth more than the last cell.
  CHECK(chosenOf(covers, worth, 0.5, 2, 3) == std::vector<std::size_t>{0});
  CHECK(chosenOf(covers, worth, 0.5, 8, 3) == std::vector<std::size_t>{0});
  CHECK(chosenOf(covers, worth, 2, 2, 3).empty());
  CHECK(chosenOf(covers, worth, 2, 2, 1) == std::vector<std::size_t>{1});
  // If no cell gains anything, the given order decides.
  const std::vector<CellCover> none(3);
  CHECK(chosenOf(none, worth, 0, 2, 3) == std::vector<std::size_t>{0, 1});
}

TEST_CASE("the chosen cells cover at least (1 - 1/e) of the optimal coverage") {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int repeat = 0; repeat < 50; ++repeat) {
    constexpr std::size_t kCells = 8, kMost = 3;
    std::vector<CellCover> covers(kCells);
    std::vector<double> worth(kCells);
    for (std::size_t c = 0; c < kCells; ++c) {
      worth[c] = 0.1 + unit(random);
      for (std::size_t tile = 0; tile < kCoverTiles; ++tile) covers[c][tile] = unit(random) < 0.3;
    }
    const auto value = [&](unsigned set) {
      double sum = 0;
      for (std::size_t tile = 0; tile < kCoverTiles; ++tile) {
        double best = 0;
        for (std::size_t c = 0; c < kCells; ++c)
          if ((set >> c & 1) != 0 && covers[c][tile]) best = std::max(best, worth[c]);
        sum += best;
      }
      return sum;
    };
    double best = 0;
    for (unsigned set = 0; set < 1u << kCells; ++set)
      if (std::popcount(set) == int(kMost)) best = std::max(best, value(set));
    unsigned chosen = 0;
    for (const std::size_t c : chosenOf(covers, worth, 0, kMost, kCells)) chosen |= 1u << c;
    CHECK(std::popcount(chosen) == int(kMost));
    CHECK(value(chosen) >= (1 - 1 / std::numbers::e) * best);
  }
}

TEST_CASE("the choice that skips gains which are too small is that of computing all gains") {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int repeat = 0; repeat < 200; ++repeat) {
    const std::size_t count = 1 + random() % 64, most = 1 + random() % 16, forced = random() % (2 * count);
    const double behind = repeat % 2 ? 0.0 : 0.2 * unit(random);
    std::vector<CellCover> covers(count);
    std::vector<double> worth(count);
    for (std::size_t c = 0; c < count; ++c) {
      worth[c] = double(1 + random() % 8) / 8;  // equal gains occur
      for (std::size_t tile = 0; tile < kCoverTiles; ++tile) covers[c][tile] = unit(random) < 0.4;
    }
    // Every gain of every step.
    std::vector<float> covered(kCoverTiles, float(behind));
    std::vector<std::size_t> all;
    const auto take = [&](std::size_t c) {
      all.push_back(c);
      for (std::size_t tile = 0; tile < kCoverTiles; ++tile)
        if (covers[c][tile]) covered[tile] = std::max(covered[tile], float(worth[c]));
    };
    if (behind == 0 && count <= most) {
      for (std::size_t c = 0; c < count; ++c) all.push_back(c);
    } else {
      if (forced < count) take(forced);
      while (all.size() < std::min(most, count)) {
        std::size_t best = count;
        float largest = -1;
        for (std::size_t c = 0; c < count; ++c) {
          if (std::ranges::count(all, c)) continue;
          float gain = 0;
          for (std::size_t tile = 0; tile < kCoverTiles; ++tile)
            gain += std::max(0.0f, (covers[c][tile] ? float(worth[c]) : 0.0f) - covered[tile]);
          if (gain > largest) largest = gain, best = c;
        }
        if (behind > 0 && !(largest > 0)) break;
        take(best);
      }
    }
    std::ranges::sort(all);
    CHECK(chosenOf(covers, worth, behind, most, forced) == all);
  }
}

TEST_CASE("covers are computed only of cells that may be chosen") {
  std::vector<double> worth{1};
  worth.resize(64, 0.1);
  std::vector<std::size_t> computed;
  const auto coverOf = [&](std::size_t c) {
    computed.push_back(c);
    CellCover cover;
    cover.set(c < 2 ? c : 40 + c % 8);
    return c == 0 ? tilesOfViews(1) : cover;
  };
  // The first cell covers the whole view with more worth than any other.
  CHECK(coveringCells(std::ref(coverOf), tilesOfViews(1), worth, 0, 12, 64).size() == 12);
  CHECK(computed == std::vector<std::size_t>{0});
  computed.clear();
  CHECK(coveringCells(std::ref(coverOf), tilesOfViews(1), worth, 0.085, 12, 64).size() == 1);
  CHECK(computed == std::vector<std::size_t>{0});
  // A forced cell is computed, too.
  computed.clear();
  CHECK(coveringCells(std::ref(coverOf), tilesOfViews(1), worth, 0, 12, 1).size() == 12);
  CHECK(computed == std::vector<std::size_t>{1, 0});
}
