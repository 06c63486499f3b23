// SPDX-License-Identifier: Apache-2.0
#include "lab/generate/walk_hall.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "base/random.h"

namespace ibr {
namespace {

// Lengths in metres.
constexpr double kHalfX = 5.5, kHalfZ = 4, kHeight = 3.2;
constexpr double kPanel = 1.9;      // about; width of a piece of wall of one material
constexpr double kInFront = 0.012;  // of posters, from what they hang on
constexpr double kFree = 0.35;      // around a camera
constexpr glm::dvec3 kUp{0, 1, 0};

class Builder {
 public:
  explicit Builder(std::uint64_t seed) : random_(seed), seed_(std::uint32_t(seed * 4096)) {}

  double uniform(double low, double high) { return random_.uniform(low, high); }
  bool chance(double share) { return uniform(0, 1) < share; }

  void add(glm::dvec3 origin, glm::dvec3 u, glm::dvec3 v, double extentU, double extentV, Material material) {
    hall.surfaces.push_back({origin, u, v, extentU, extentV, material, ++seed_});
  }
  // A box that stands at `foot`, turned about its vertical axis. Its underside is left out where it stands on the
  // floor.
  void addBox(glm::dvec3 foot, glm::dvec3 size, double yaw, Material sides, Material top) {
    const glm::dvec3 u(std::cos(yaw), 0, -std::sin(yaw)), w(std::sin(yaw), 0, std::cos(yaw));
    const glm::dvec3 middle = foot + 0.5 * size.y * kUp;
    for (const double side : {-0.5, 0.5}) {
      add(middle + side * size.z * w, u, kUp, size.x, size.y, sides);
      add(middle + side * size.x * u, w, kUp, size.z, size.y, sides);
    }
    if (foot.y + size.y < kHeight) add(foot + size.y * kUp, u, w, size.x, size.z, top);
    if (foot.y > 0) add(foot, u, w, size.x, size.z, top);
  }
  void addObstacle(glm::dvec3 at, double radius, double top) { hall.obstacles.push_back({{at.x, at.z}, radius, top}); }

  WalkHall hall;

 private:
  Random random_;
  std::uint32_t seed_;
};

void addWall(Builder& b, glm::dvec3 corner, glm::dvec3 along, glm::dvec3 inward, double length) {
  constexpr std::array kMaterials{Material::brick, Material::stone, Material::planks};
  const double panels = std::round(length / kPanel), wide = length / panels;
  for (int p = 0; p < int(panels); ++p) {
    const glm::dvec3 foot = corner + along * ((p + 0.5) * wide);
    b.add(foot + kUp * (kHeight / 2), along, kUp, wide, kHeight, kMaterials[std::size_t(b.uniform(0, 2.999))]);
    for (const double height : {1.25, 2.35}) {
      const double width = b.uniform(0.45, 1.1), tall = b.uniform(0.45, 0.95);
      const double shift = b.uniform(-0.5, 0.5) * (wide - width);
      b.add(foot + along * shift + kUp * (height + b.uniform(-0.1, 0.1)) + inward * kInFront, along, kUp, width, tall,
            Material::poster);
    }
    const double yaw = std::atan2(inward.x, inward.z) + b.uniform(-0.5, 0.5);
    const glm::dvec3 at = foot + along * b.uniform(-0.5, 0.5) + inward * b.uniform(0.5, 0.75);
    if (b.chance(0.65)) {
      const double size = b.uniform(0.4, 0.7), tall = b.uniform(0.35, 0.8);
      b.addBox(at, {size, tall, b.uniform(0.35, 0.6)}, yaw, Material::crate, Material::planks);
      double top = tall;
      if (b.chance(0.6)) {
        const double small = 0.65 * size;
        b.addBox(at + tall * kUp, {small, small, small}, yaw + b.uniform(-0.6, 0.6), Material::crate, Material::crate);
        top += small;
      }
      b.addObstacle(at, 0.5, top);
    } else {
      const double tall = b.uniform(1.2, 2.0);
      b.add(at + kUp * (tall / 2), {std::cos(yaw), 0, -std::sin(yaw)}, kUp, b.uniform(0.6, 1), tall,
            b.chance(0.5) ? Material::poster : Material::cloth);
      b.addObstacle(at, 0.55, tall);
    }
  }
}

void addMiddle(Builder& b) {
  for (const double x : {-1.35, 1.35}) {
    const glm::dvec3 at(x + b.uniform(-0.1, 0.1), 0, b.uniform(-0.15, 0.15));
    b.addBox(at, {0.42, kHeight, 0.42}, b.uniform(-0.5, 0.5), Material::brick, Material::brick);
    b.addObstacle(at, 0.3, kHeight);
  }
  for (int i = 0; i < 5; ++i) {
    const glm::dvec3 at(-0.8 + 0.4 * i + b.uniform(-0.1, 0.1), 0, (i % 2 == 0 ? 0.3 : -0.3) + b.uniform(-0.1, 0.1));
    const double size = b.uniform(0.35, 0.55), tall = b.uniform(0.3, 1.1), yaw = b.uniform(-0.8, 0.8);
    b.addBox(at, {size, tall, size}, yaw, Material::crate, Material::planks);
    if (b.chance(0.7))
      b.addBox(at + tall * kUp, glm::dvec3(0.3), yaw + b.uniform(-0.5, 0.5), Material::crate, Material::crate);
    b.addObstacle(at, 0.4, tall + 0.3);
  }
  for (int i = 0; i < 4; ++i) {
    const double yaw = b.uniform(-1.5, 1.5), tall = b.uniform(0.7, 1);
    b.add({-0.9 + 0.6 * i, 2.9 - tall / 2, b.uniform(-0.5, 0.5)}, {std::cos(yaw), 0, -std::sin(yaw)}, kUp,
          b.uniform(0.4, 0.7), tall, Material::cloth);
  }
}

}  // namespace

bool WalkHall::hasRoom(glm::dvec3 position) const {
  if (std::abs(position.x) > kHalfX - kFree || std::abs(position.z) > kHalfZ - kFree || position.y < kFree ||
      position.y > kHeight - kFree)
    return false;
  return std::ranges::none_of(obstacles, [&](const Obstacle& o) {
    return position.y < o.top + kFree && glm::length(glm::dvec2(position.x, position.z) - o.centre) < o.radius + kFree;
  });
}

WalkHall makeWalkHall(std::uint64_t seed) {
  Builder b(seed);
  b.add({0, 0, 0}, {1, 0, 0}, {0, 0, 1}, 2 * kHalfX, 2 * kHalfZ, Material::tiles);
  b.add({0, kHeight, 0}, {1, 0, 0}, {0, 0, 1}, 2 * kHalfX, 2 * kHalfZ, Material::planks);
  addWall(b, {-kHalfX, 0, -kHalfZ}, {1, 0, 0}, {0, 0, 1}, 2 * kHalfX);
  addWall(b, {kHalfX, 0, -kHalfZ}, {0, 0, 1}, {-1, 0, 0}, 2 * kHalfZ);
  addWall(b, {kHalfX, 0, kHalfZ}, {-1, 0, 0}, {0, 0, -1}, 2 * kHalfX);
  addWall(b, {-kHalfX, 0, kHalfZ}, {0, 0, -1}, {1, 0, 0}, 2 * kHalfZ);
  for (double x = -4.4; x < kHalfX; x += 2.2)
    b.addBox({x, kHeight - 0.22, 0}, {0.2, 0.22, 2 * kHalfZ}, 0, Material::planks, Material::planks);
  addMiddle(b);
  return std::move(b.hall);
}

}  // namespace ibr
