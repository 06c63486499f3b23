// SPDX-License-Identifier: Apache-2.0
#include "author/graph/lattice.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <numeric>
#include <random>

using namespace ibr;

namespace {

std::vector<glm::dvec3> gridPlaces(int nx, int ny, int nz, glm::dvec3 steps, double noise) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  std::vector<glm::dvec3> places;
  for (int z = 0; z < nz; ++z)
    for (int y = 0; y < ny; ++y)
      for (int x = 0; x < nx; ++x)
        places.push_back(steps * glm::dvec3(x, y, z) +
                         noise * glm::dvec3(normal(random), normal(random), normal(random)));
  return places;
}

std::vector<std::uint32_t> all(std::size_t count) {
  std::vector<std::uint32_t> list(count);
  std::iota(list.begin(), list.end(), 0u);
  return list;
}

}  // namespace

TEST_CASE("levels are found for grids of any step, noise, position and rotation") {
  const double noise = GENERATE(0.0, 0.02);
  const glm::dvec3 steps = GENERATE(glm::dvec3(1, 1, 1), glm::dvec3(3, 1, 1.4), glm::dvec3(1, 5, 2));
  const auto places = gridPlaces(4, 3, 2, steps, noise);
  const glm::dquat turn = glm::normalize(glm::dquat(0.9, 0.1, -0.4, 0.3));
  const double scale = GENERATE(1.0, 250.0);
  std::vector<glm::dvec3> moved;
  for (const glm::dvec3& p : places) moved.push_back(glm::dvec3(1e3, -20, 7) + scale * (turn * p));
  const auto lattice = findLattice(moved);
  REQUIRE(lattice);
  CHECK(lattice->rank == 3);
  REQUIRE(lattice->levels.size() == 24);
  // The order of the axes is unspecified, but neighbours differ by one level along one axis.
  for (std::uint32_t p = 0; p + 1 < 24; ++p) {
    int difference = 0;
    for (std::size_t a = 0; a < 3; ++a) difference += std::abs(lattice->levels[p][a] - lattice->levels[p + 1][a]);
    if (p % 4 != 3) CHECK(difference == 1);
  }
  CHECK(findLattice(places)->levels == lattice->levels);
}

TEST_CASE("a full grid is split by Kuhn's scheme: faces of neighbours agree and the volume is filled") {
  const auto places = gridPlaces(4, 3, 3, {1, 1, 1}, 0);
  const auto lattice = findLattice(places);
  REQUIRE(lattice);
  const auto chosen = all(places.size());
  const std::vector<Simplex> simplices = splitLattice(*lattice, chosen);
  CHECK(simplices.size() == 6 * 3 * 2 * 2);
  double volume = 0;
  std::map<Simplex, int> faceCount;
  for (const Simplex& s : simplices) {
    volume += std::abs(glm::dot(glm::cross(places[s[1]] - places[s[0]], places[s[2]] - places[s[0]]),
                                places[s[3]] - places[s[0]])) /
              6;
    for (std::size_t a = 0; a < 3; ++a) {  // of one cube
      int low = 1000, high = 0;
      for (const std::uint32_t p : s) {
        low = std::min(low, lattice->levels[p][a]);
        high = std::max(high, lattice->levels[p][a]);
      }
      CHECK(high - low == 1);
    }
    for (const Simplex& face : faces(s)) ++faceCount[face];
  }
  CHECK(volume == Approx(12));
  std::size_t outer = 0;
  for (const auto& [face, number] : faceCount) {
    CHECK(number <= 2);
    outer += number == 1;
  }
  CHECK(outer == 2 * 2 * (4 - 1) * (3 - 1) * 2 + 2 * 2 * (3 - 1) * (3 - 1));
}

TEST_CASE("planes and rows of a lattice are split in their own rank, and holes are closed") {
  const auto places = gridPlaces(4, 3, 2, {1, 2, 1}, 0.01);
  const auto lattice = findLattice(places);
  REQUIRE(lattice);
  std::vector<std::uint32_t> floor, row;
  for (std::uint32_t p = 0; p < 12; ++p) floor.push_back(p);
  for (std::uint32_t p = 0; p < 4; ++p) row.push_back(p);
  CHECK(splitLattice(*lattice, floor).size() == 12);
  CHECK(splitLattice(*lattice, row) == std::vector<Simplex>{{0, 1}, {1, 2}, {2, 3}});
  CHECK(extent(*lattice, floor) == 2);
  CHECK(extent(*lattice, row) == 1);
  floor.erase(floor.begin() + 5);  // removes a middle position, whose six triangles become four
  CHECK(splitLattice(*lattice, floor).size() == 10);
  CHECK(splitLattice(*lattice, std::vector<std::uint32_t>{3}).empty());
}

TEST_CASE("positions off a rectangular grid give no lattice") {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(0, 4);
  std::vector<glm::dvec3> cloud, ring, hexagonal;
  for (int i = 0; i < 40; ++i) cloud.emplace_back(uniform(random), uniform(random), uniform(random));
  for (int i = 0; i < 12; ++i) ring.emplace_back(std::cos(0.52 * i), std::sin(0.52 * i), 0);
  for (int i = 0; i < 20; ++i) hexagonal.emplace_back(i % 5 + 0.5 * (i / 5), 0.866 * (i / 5), 0);
  CHECK_FALSE(findLattice(cloud));
  CHECK_FALSE(findLattice(ring));
  CHECK_FALSE(findLattice(hexagonal));
  CHECK_FALSE(findLattice(gridPlaces(4, 3, 2, {1, 1, 1}, 0.2)));
  CHECK_FALSE(findLattice({}));
  CHECK_FALSE(findLattice(std::vector<glm::dvec3>(2, glm::dvec3(0.0))));
  CHECK_FALSE(findLattice(std::vector<glm::dvec3>(5, glm::dvec3(1.0))));
  auto twice = gridPlaces(3, 3, 1, {1, 1, 1}, 0);
  twice.push_back(twice[4]);
  CHECK_FALSE(findLattice(twice));
}
