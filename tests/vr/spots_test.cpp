// SPDX-License-Identifier: Apache-2.0
#include "vr/walk/spots.h"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <limits>
#include <span>

#include "any_tracking.h"

using namespace ibr;
using namespace ibr::app;
using ibr::test::angleBetween;
using ibr::test::AnyTracking;

namespace {

const glm::dvec3 kUp(0, 1, 0);
const double kNaN = std::numeric_limits<double>::quiet_NaN();

glm::dquat looking(double heading, double pitch = 0) {
  return glm::angleAxis(heading, kUp) * glm::angleAxis(pitch, glm::dvec3(1, 0, 0));
}

Spot spotAt(glm::dvec3 position) {
  return {position, {0, 0, -1}, {0}};
}

Ray towards(glm::dvec3 from, glm::dvec3 to) {
  return {from, to - from};
}

// The reference implementation of pointedSpot: compares all spots; photographs are 1.6 above the ground.
std::optional<std::size_t> pointedOfAll(const std::vector<Spot>& spots, const Ray& ray, std::optional<std::size_t> held,
                                        const PointingSettings& settings) {
  const auto angleTo = [&](glm::dvec3 point) {
    const glm::dvec3 to = point - ray.origin, direction = glm::normalize(ray.direction);
    if (!(glm::length(to) > settings.minDistance)) return glm::pi<double>();
    return std::atan2(glm::length(glm::cross(direction, to)), glm::dot(direction, to));
  };
  const auto angle = [&](std::size_t spot) {
    return std::min(angleTo(spots[spot].position), angleTo(groundOf(spots[spot], kUp, 1.6)));
  };
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < spots.size(); ++i) best = std::min(best, angle(i));
  if (held && angle(*held) <= settings.cone + settings.hold && angle(*held) <= best + settings.hold) return held;
  std::optional<std::size_t> nearest;
  for (std::size_t i = 0; i < spots.size(); ++i)
    if (angle(i) <= std::min(best + settings.tie, settings.cone) &&
        (!nearest ||
         glm::distance(spots[i].position, ray.origin) < glm::distance(spots[*nearest].position, ray.origin)))
      nearest = i;
  return nearest;
}

std::optional<std::size_t> nearestOfAll(const std::vector<Spot>& spots, glm::dvec3 position) {
  const auto away = [&](const Spot& spot) {
    return std::hypot(spot.position.x - position.x, spot.position.z - position.z);
  };
  const auto nearest = std::ranges::min_element(spots, {}, away);
  return nearest == spots.end() ? std::nullopt : std::optional(std::size_t(nearest - spots.begin()));
}

}  // namespace

TEST_CASE("spots: one per capture site, at the mean position and with the mean facing of its photographs") {
  std::vector<Pose> cameras{{{0, 0, 0}, looking(0.2)},
                            {{3, 0, 0}, looking(1, -0.6)},
                            {{0, 0, 0}, looking(-0.4, 0.5)},
                            {{6, 0, 0}, looking(0)}};
  const std::vector<Spot> spots = spotsOf(cameras, kUp);
  REQUIRE(spots.size() == 3);
  CHECK(spots[0].nodes == std::vector<std::uint32_t>{0, 2});
  CHECK(spots[0].position == glm::dvec3(0));
  CHECK(angleBetween(spots[0].facing, looking(-0.1) * glm::dvec3(0, 0, -1)) < 1e-12);
  CHECK(angleBetween(spots[1].facing, looking(1) * glm::dvec3(0, 0, -1)) < 1e-12);
  CHECK(spots[2].nodes == std::vector<std::uint32_t>{3});
  CHECK(spotsOf({}, kUp).empty());
  // An exposure bracket whose poses were estimated separately.
  cameras.push_back({{3.006, 0.003, 0}, looking(1)});
  cameras.push_back({{3, 0, -0.006}, looking(1)});
  const std::vector<Spot> bracketed = spotsOf(cameras, kUp);
  REQUIRE(bracketed.size() == 3);
  CHECK(glm::distance(bracketed[1].position, glm::dvec3(3.002, 0.001, -0.002)) < 1e-12);
}

TEST_CASE("spots: a panorama faces as its first photograph, and facing is level for any up") {
  std::vector<Pose> cameras;
  for (int i = 0; i < 8; ++i) cameras.push_back({{1e7, -1e7, 3}, looking(0.7 + i * glm::quarter_pi<double>(), 0.3)});
  cameras.push_back({{1e7 + 5, -1e7, 3}, looking(0)});
  const std::vector<Spot> spots = spotsOf(cameras, kUp);
  REQUIRE(spots.size() == 2);
  CHECK(spots[0].nodes.size() == 8);
  CHECK((spots[0].position == cameras[0].position));  // bit for bit
  CHECK(angleBetween(spots[0].facing, looking(0.7) * glm::dvec3(0, 0, -1)) < 1e-9);

  AnyTracking any(11);
  for (int i = 0; i < 100; ++i) {
    const glm::dvec3 up = any.unit();
    const glm::dquat tilt = levelTracking(up).rotation;
    const Spot spot = spotsOf({{any.unit(), tilt * any.head().rotation}}, up).front();
    REQUIRE(glm::length(spot.facing) == Approx(1).margin(1e-12));
    REQUIRE(std::abs(glm::dot(spot.facing, up)) < 1e-9);
  }
}

TEST_CASE("standing at a spot puts the head above its ground, and keeps the photographs' height above the floor") {
  AnyTracking any(12);
  for (const double far : {0.0, 1e7})
    for (int i = 0; i < 300; ++i) {
      const Tracking now = any.tracking(far, 3);
      const Pose head = any.head();
      Spot spot = spotAt(far * any.unit() + any.unit());
      spot.facing = facingOf(any.tracking(0, 0).rotation, upInWorld(now));
      const double height = any.between(0.5, 3), rounding = 1e-14 * (4 * far + 100 * now.unitsPerMetre + 10);
      const Tracking stood = standAt(now, head, spot, height);
      const glm::dvec3 inRoom = inTracking(stood, spot.position);
      const double metres = rounding / now.unitsPerMetre;
      REQUIRE(std::abs(inRoom.x - head.position.x) <= metres);
      REQUIRE(std::abs(inRoom.z - head.position.z) <= metres);
      REQUIRE(std::abs(inRoom.y - height) <= metres);
      REQUIRE(stood.rotation == now.rotation);
      REQUIRE(stood.unitsPerMetre == now.unitsPerMetre);
      // A person's own height is preserved.
      const glm::dvec3 eyes = inWorld(stood, head.position), up = upInWorld(stood);
      REQUIRE(glm::dot(eyes - spot.position, up) ==
              Approx((head.position.y - height) * now.unitsPerMetre).margin(rounding));

      const Tracking faced = standAt(now, head, spot, height, spot.facing);
      REQUIRE(angleBetween(facingOf(inWorld(faced, head).rotation, up), spot.facing) < 1e-6);
      REQUIRE(glm::distance(inTracking(faced, spot.position), glm::dvec3(head.position.x, height, head.position.z)) <=
              metres);

      // Scaling at the spot equals standing at the spot with the new scale.
      const double scale = now.unitsPerMetre * any.between(0.01, 100);
      Tracking larger = now;
      larger.unitsPerMetre = scale;
      const Tracking a = scaled(stood, head, height, scale), b = standAt(larger, head, spot, height);
      REQUIRE(glm::distance(a.origin, b.origin) <= rounding * (1 + scale / now.unitsPerMetre));
    }
}

TEST_CASE("pointing: the photographs' position and the mark on the ground are hit within the cone") {
  const Spots spots({spotAt({0, 1.6, -4}), spotAt({4, 1.6, 0}), spotAt({-4, 1.6, 0})});
  const glm::dvec3 hand(0, 1.2, 0);
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(pointedSpot(spots, towards(hand, spots[i].position), kUp, 1.6) == i);
    CHECK(pointedSpot(spots, towards(hand, groundOf(spots[i], kUp, 1.6)), kUp, 1.6) == i);
  }
  CHECK(groundOf(spots[0], kUp, 1.6) == glm::dvec3(0, 0, -4));
  CHECK(!pointedSpot(spots, {hand, {0, 0.1, 1}}, kUp, 1.6));
  CHECK(!pointedSpot(spots, {hand, {1, 0.1, -1}}, kUp, 1.6));
  CHECK(!pointedSpot({}, {hand, {0, 0, -1}}, kUp, 1.6));
  // The cone's edge, on both sides.
  const auto off = [&](double degrees) {
    return Ray{{0, 1.6, 0}, glm::angleAxis(glm::radians(degrees), kUp) * glm::dvec3(0, 0, -1)};
  };
  CHECK(pointedSpot(spots, off(5.9), kUp, 1.6) == 0u);
  CHECK(!pointedSpot(spots, off(6.2), kUp, 1.6));
}

TEST_CASE("pointing: the nearest spot in line is selected, with hysteresis") {
  const Spots line({spotAt({0, 1.6, -12}), spotAt({0, 1.6, -3}), spotAt({0, 1.6, -6})});
  CHECK(pointedSpot(line, {{0, 1.6, 0}, {0, 0, -1}}, kUp, 1.6) == 1u);
  CHECK(pointedSpot(line, towards({0, 1.5, 0}, {0, 0, -12}), kUp, 1.6) == 0u);
  CHECK(pointedSpot(line, towards({0, 1.62, 0}, line[0].position), kUp, 1.6) == 1u);  // nearly in line

  const Spots pair({spotAt({-0.2, 1.6, -4}), spotAt({0.2, 1.6, -4})});
  const auto at = [](double degrees) {
    return Ray{{0, 1.6, 0}, glm::angleAxis(glm::radians(degrees), kUp) * glm::dvec3(0, 0, -1)};
  };
  CHECK(pointedSpot(pair, at(2), kUp, 1.6) == 0u);
  CHECK(pointedSpot(pair, at(-2), kUp, 1.6) == 1u);
  CHECK(pointedSpot(pair, at(-0.4), kUp, 1.6, 0) == 0u);
  CHECK(pointedSpot(pair, at(-0.7), kUp, 1.6, 0) == 1u);
  CHECK(pointedSpot(pair, at(0.4), kUp, 1.6, 1) == 1u);
  // A trembling hand aimed between both does not change the selection.
  AnyTracking any(13);
  std::optional<std::size_t> held = pointedSpot(pair, at(2), kUp, 1.6);
  for (int i = 0; i < 200; ++i) REQUIRE((held = pointedSpot(pair, at(any.between(-0.4, 0.4)), kUp, 1.6, held)) == 0u);
  // A selected spot stays selected slightly beyond the cone. A spot that does not exist is not selected.
  CHECK(pointedSpot(pair, at(2.86 + 6.8), kUp, 1.6, 0) == 0u);
  CHECK(!pointedSpot(pair, at(2.86 + 6.8), kUp, 1.6));
  CHECK(!pointedSpot(pair, at(2.86 + 7.3), kUp, 1.6, 0));
  CHECK(pointedSpot(pair, at(2), kUp, 1.6, 7) == 0u);
}

TEST_CASE("pointing: invariant to origin, scale and up, and ignores spots behind, too near or not finite") {
  AnyTracking any(14);
  int pointed = 0;
  for (int i = 0; i < 300; ++i) {
    std::vector<Spot> spots, moved;
    const Tracking to = any.tracking(1e7, 1);
    for (int k = 0; k < 30; ++k) spots.push_back(spotAt(4.0 * any.unit()));
    for (const Spot& spot : spots) moved.push_back(spotAt(inWorld(to, spot.position)));
    const Ray ray{any.unit(), any.unit()};
    const auto here = pointedSpot(Spots(spots), ray, kUp, 1.6);
    REQUIRE(here == pointedSpot(Spots(moved), {inWorld(to, ray.origin), to.rotation * (100.0 * ray.direction)},
                                upInWorld(to), 1.6 * to.unitsPerMetre));
    pointed += here.has_value();
  }
  CHECK(pointed > 20);
  CHECK(pointed < 280);
  const Spots one({spotAt({0, 0, -1})});
  CHECK(!pointedSpot(one, {{0, 0, 0}, {0, 0, 1}}, kUp, 0));
  CHECK(pointedSpot(one, {{0, 0, 0}, {0, 0, -1}}, kUp, 0) == 0u);
  PointingSettings far;
  far.minDistance = 2;
  CHECK(!pointedSpot(one, {{0, 0, 0}, {0, 0, -1}}, kUp, 0, std::nullopt, far));
  for (const Ray& ray : {Ray{{0, 0, 0}, {0, 0, 0}}, Ray{{kNaN, 0, 0}, {0, 0, -1}}, Ray{{0, 0, 0}, {0, kNaN, -1}}})
    CHECK(!pointedSpot(one, ray, kUp, 0));
  CHECK(!pointedSpot(one, {{0, 0, -1}, {0, 0, -1}}, kUp, 0));  // exactly at the spot
  const Spots broken({spotAt({kNaN, 0, 0}), spotAt({0, 0, -1})});
  CHECK(pointedSpot(broken, {{0, 0, 0}, {0, 0, -1}}, kUp, 0) == 1u);
}

TEST_CASE("pointing: finds the spot that a comparison of all spots finds") {
  AnyTracking any(16);
  int pointed = 0, held = 0;
  for (int set = 0; set < 60; ++set) {
    std::vector<Spot> all;
    const int count = set == 0 ? 0 : set == 1 ? 1 : 200;
    const glm::dvec3 far = (set % 3 == 0 ? 1e6 : 0) * any.unit();
    for (int k = 0; k < count; ++k) {
      glm::dvec3 at = any.between(0, 10) * any.unit();
      if (set % 4 == 0) at.y = 1.6;           // on level ground
      if (set % 5 == 0) at = glm::round(at);  // many at one position
      all.push_back(spotAt(far + at));
    }
    const Spots spots(all);
    std::optional<std::size_t> before;
    for (int i = 0; i < 100; ++i) {
      const Ray ray{far + any.between(0, 12) * any.unit(), any.unit()};
      PointingSettings settings;
      settings.minDistance = i % 2;
      const auto found = pointedSpot(spots, ray, kUp, 1.6, before, settings);
      REQUIRE(found == pointedOfAll(all, ray, before, settings));
      pointed += found.has_value();
      held += found && found == before;
      if (found) before = found;
      REQUIRE(nearestSpot(spots, ray.origin, kUp) == nearestOfAll(all, ray.origin));
    }
  }
  CHECK(pointed > 1000);
  CHECK(held > 10);
}

TEST_CASE("the nearest spots are found in order, and not beyond the distance or the number") {
  AnyTracking any(17);
  std::vector<Spot> all{spotAt({kNaN, 0, 0})};
  for (int k = 0; k < 500; ++k) all.push_back(spotAt(glm::round(5.0 * any.unit() * any.between(0, 2))));
  const Spots spots(all);
  for (int i = 0; i < 100; ++i) {
    const glm::dvec3 at = 8.0 * any.unit();
    const double limit = any.between(0, 12);
    std::vector<SpotDistance> expected;
    for (std::uint32_t k = 1; k < all.size(); ++k)
      if (const double distance = glm::distance(all[k].position, at); distance < limit)
        expected.push_back({distance, k});
    std::ranges::sort(expected);
    for (const std::size_t size : {0, 1, 20, 1000}) {
      std::vector<SpotDistance> found(size);
      found.resize(nearestSpots(spots, at, limit, found));
      REQUIRE(found.size() == std::min(size, expected.size()));
      REQUIRE(std::ranges::equal(found, std::span(expected).first(found.size())));
    }
  }
  CHECK(nearestSpots(Spots(), {0, 0, 0}, 1, std::span<SpotDistance>()) == 0);
}

TEST_CASE("searches for spots compare few spots, however many there are") {
  std::array<std::array<std::size_t, 3>, 2> compared{};
  for (std::size_t i = 0; i < 2; ++i) {
    const int side = i == 0 ? 50 : 450;
    std::vector<Spot> all;
    for (int k = 0; k < side * side; ++k) all.push_back(spotAt({k % side, 1.6, k / side}));
    const Spots spots(all);
    AnyTracking any(18);
    for (int k = 0; k < 200; ++k) {
      const glm::dvec3 at = 0.5 * side + 0.3 * side * any.unit() * glm::dvec3(1, 0, 1);
      std::array<SpotDistance, 100> found;
      glm::dvec3 ahead = any.unit();
      ahead.y = -std::abs(ahead.y) - 0.1;
      pointedSpot(spots, {{at.x, 1.2, at.z}, ahead}, kUp, 1.6, std::nullopt, {}, &compared[i][0]);
      nearestSpot(spots, at, kUp, &compared[i][1]);
      nearestSpots(spots, {at.x, 1.6, at.z}, 60, found, &compared[i][2]);
    }
  }
  for (std::size_t search = 0; search < 3; ++search) {
    CAPTURE(search, compared[0][search], compared[1][search]);
    CHECK(compared[1][search] < 3 * compared[0][search]);
    CHECK(compared[1][search] < 200 * 1000);
  }
}

TEST_CASE("a hand's ray points along its −z axis") {
  const Ray ray = rayOf({{1, 2, 3}, looking(glm::half_pi<double>())});
  CHECK(ray.origin == glm::dvec3(1, 2, 3));
  CHECK(glm::distance(ray.direction, glm::dvec3(-1, 0, 0)) < 1e-12);
}

TEST_CASE("the nearest spot is found by horizontal distance") {
  const Spots spots({spotAt({0, 50, 0}), spotAt({3, 0, 0})});
  CHECK(nearestSpot(spots, {1, 0, 0}, kUp) == 0u);
  CHECK(nearestSpot(spots, {2, 0, 0}, kUp) == 1u);
  CHECK(nearestSpot(spots, {1, 0, 0}, {1, 0, 0}) == 1u);
  CHECK(!nearestSpot({}, {0, 0, 0}, kUp));
}

TEST_CASE("the map contains all spots at one scale, with x to the right and −z upwards") {
  std::vector<Spot> spots{spotAt({-10, 0, 5}), spotAt({30, 7, 5}), spotAt({0, 1, -5})};
  const SpotMap map = mapOf(spots, kUp);
  REQUIRE(map.places.size() == 3);
  CHECK(map.places[0].x < map.places[2].x);
  CHECK(map.places[2].y < map.places[0].y);
  const double side = 40 / (1 - 0.16);
  CHECK(glm::distance(map.places[0], glm::dvec2(0.08, 0.5 + 5 / side)) < 1e-12);
  CHECK(glm::distance(map.places[1], glm::dvec2(0.92, 0.5 + 5 / side)) < 1e-12);
  CHECK(glm::distance(onMap(map, {0, 99, -5}), map.places[2]) < 1e-12);  // seen from above
  CHECK(onMap(map, {1e9, 0, -1e9}) == glm::dvec2(1, 0));
  CHECK(glm::distance(directionOnMap(map, {0, 3, -2}), glm::dvec2(0, -1)) < 1e-12);
  CHECK(directionOnMap(map, {0, 3, 0}) == glm::dvec2(0));
  CHECK(directionOnMap(map, {0, 0, 0}) == glm::dvec2(0));
}

TEST_CASE("the map is valid at any origin, scale and up, for one spot and for none") {
  AnyTracking any(15);
  for (const double scale : {1e-9, 1.0, 1e9})
    for (int i = 0; i < 30; ++i) {
      const glm::dvec3 up = i == 0 ? glm::dvec3(1, 0, 0) : any.unit(), far = 1e6 * scale * any.unit();
      std::vector<Spot> spots;
      for (int k = 0; k < 20; ++k) spots.push_back(spotAt(far + scale * any.unit()));
      const SpotMap map = mapOf(spots, up);
      REQUIRE(std::abs(glm::dot(map.right, up)) < 1e-12);
      REQUIRE(glm::distance(glm::cross(map.right, map.down), -up) < 1e-12);
      double least = 1, most = 0;
      for (const glm::dvec2& place : map.places) {
        least = std::min({least, place.x, place.y});
        most = std::max({most, place.x, place.y});
      }
      REQUIRE(least >= 0.08 - 1e-6);
      REQUIRE(most <= 0.92 + 1e-6);
      REQUIRE(most - least > 0.5);
      // Distances on the map equal horizontal distances; heights do not count.
      const glm::dvec3 between = spots[0].position - spots[1].position, flat = between - glm::dot(between, up) * up;
      REQUIRE(glm::distance(map.places[0], map.places[1]) == Approx(glm::length(flat) / map.side).epsilon(1e-6));
    }
  const SpotMap one = mapOf({spotAt({5, 6, 7})}, kUp);
  CHECK(one.places.front() == glm::dvec2(0.5));
  CHECK(one.side > 0);
  const SpotMap none = mapOf({}, kUp);
  CHECK(none.places.empty());
  CHECK(std::isfinite(onMap(none, {1, 2, 3}).x));
}
