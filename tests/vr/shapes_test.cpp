// SPDX-License-Identifier: Apache-2.0
#include "vr/walk/shapes.h"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <limits>

#include "any_tracking.h"

using namespace ibr;
using namespace ibr::app;
using ibr::test::angleBetween;
using ibr::test::AnyTracking;

namespace {

using Vertices = std::vector<ShapeVertex>;

const double kNaN = std::numeric_limits<double>::quiet_NaN();
const double kWidest = std::tan(glm::radians(89.9));
const Pose kHead{{0, 1.7, 0}, {1, 0, 0, 0}};

double alpha(const ShapeVertex& vertex) {
  return double(vertex.colour >> 24) / 255;
}

bool isWhole(const Vertices& vertices) {
  return vertices.size() % 3 == 0 && std::ranges::all_of(vertices, [](const ShapeVertex& v) {
           return std::isfinite(v.position.x) && std::isfinite(v.position.y) && std::isfinite(v.position.z);
         });
}

double cross(glm::dvec2 a, glm::dvec2 b) {
  return a.x * b.y - a.y * b.x;
}

// Coverage of the background at a tangent by all triangles, drawn one after another.
double cover(const Vertices& vertices, glm::dvec2 at) {
  double left = 1;
  for (std::size_t i = 0; i + 2 < vertices.size(); i += 3) {
    std::array<glm::dvec2, 3> corner;
    for (std::size_t k = 0; k < 3; ++k) corner[k] = glm::dvec2(vertices[i + k].position);
    const double area = cross(corner[1] - corner[0], corner[2] - corner[0]);
    const double a = cross(corner[1] - at, corner[2] - at) / area, b = cross(corner[2] - at, corner[0] - at) / area;
    if (!(a >= 0 && b >= 0 && a + b < 1)) continue;
    left *= 1 - (a * alpha(vertices[i]) + b * alpha(vertices[i + 1]) + (1 - a - b) * alpha(vertices[i + 2]));
  }
  return 1 - left;
}

Shapes marks(const std::vector<Spot>& spots, std::optional<std::size_t> pointed = std::nullopt,
             const Tracking& tracking = {}, const Pose& head = kHead) {
  Shapes shapes;
  addMarks(shapes, Spots(spots), tracking, head, 1.6, pointed);
  return shapes;
}

Spot spotAt(glm::dvec3 position) {
  return {position, {0, 0, -1}, {0}};
}

}  // namespace

TEST_CASE("shapes: a fade covers any field of view evenly with its strength") {
  for (const double none : {0.0, -1.0, kNaN}) {
    Shapes shapes;
    addFade(shapes, none);
    CHECK(shapes.onView.empty());
  }
  for (const double strength : {0.01, 0.5, 1.0, 7.0}) {
    Shapes shapes;
    addFade(shapes, strength);
    CHECK(isWhole(shapes.onView));
    CHECK(shapes.inSpace.empty());
    for (const double x : {-kWidest, -1.0, 0.001, kWidest})
      for (const double y : {-kWidest, 0.3, kWidest})
        CHECK(cover(shapes.onView, {x, y}) == Approx(std::min(strength, 1.0)).margin(0.003));
    for (const ShapeVertex& vertex : shapes.onView) {
      CHECK(vertex.position.z == -1);
      CHECK((vertex.colour & 0xffffff) == 0);  // black
    }
  }
}

TEST_CASE("shapes: a vignette is clear in the middle, black outside, smooth, and narrower with more strength") {
  for (const double none : {0.0, -1.0, kNaN}) {
    Shapes shapes;
    addVignette(shapes, none);
    CHECK(shapes.onView.empty());
  }
  double last = 0;
  for (const double strength : {0.001, 0.1, 0.3, 0.6, 1.0, 3.0}) {
    Shapes shapes;
    addVignette(shapes, strength);
    REQUIRE(isWhole(shapes.onView));
    for (const ShapeVertex& vertex : shapes.onView) REQUIRE(vertex.position.z == -1);
    const auto along = [&](double radius) {
      return cover(shapes.onView, radius * glm::dvec2(std::cos(0.3), std::sin(0.3)));
    };
    for (double angle = 0; angle < 20; angle += 0.5) REQUIRE(along(std::tan(glm::radians(angle))) == 0);
    double before = 0, total = 0;
    for (double angle = 20; angle < 89.9; angle += 0.25) {
      const double covers = along(std::tan(glm::radians(angle)));
      REQUIRE(covers >= before - 1e-9);
      REQUIRE(covers - before < 0.12);
      before = covers;
      total += covers;
    }
    CHECK(total >= last);
    last = total;
    if (strength >= 0.3) CHECK(before > 0.99);
    if (strength < 0.01) CHECK(before < 0.02);  // nothing appears suddenly
  }
}

TEST_CASE("shapes: a spot's mark lies on the ground below it, with a post up to its photographs") {
  const Tracking tracking = turned(scaled({}, kHead, 0, 2), kHead, 0.4);
  const glm::dvec3 place(3, 1.6, -2);
  const Shapes shapes = marks({spotAt(inWorld(tracking, place))}, std::nullopt, tracking);
  REQUIRE(isWhole(shapes.inSpace));
  CHECK(shapes.onView.empty());
  REQUIRE(!shapes.inSpace.empty());
  int ring = 0, top = 0;
  for (const ShapeVertex& vertex : shapes.inSpace) {
    const glm::dvec3 at(vertex.position);
    const double across = std::hypot(at.x - place.x, at.z - place.z);
    CHECK(across < 0.21);
    CHECK((std::abs(at.y) < 1e-5 || std::abs(at.y - 1.6) < 1e-5));
    ring += std::abs(at.y) < 1e-5 && across > 0.19;
    if (at.y > 1) {
      ++top;
      CHECK(across < 0.02);
    }
  }
  CHECK(ring >= 24);
  CHECK(top == 3);
}

TEST_CASE("shapes: marks are drawn for the nearest 500 spots within 60 m, farthest first, and the target is brighter") {
  std::vector<Spot> row;
  for (int i = 0; i < 30; ++i) row.push_back(spotAt({0, 1.6, -4.0 * i - 2}));
  std::vector<Spot> shuffled = row;
  for (std::size_t i = 0; i < row.size(); ++i) shuffled[i] = row[i * 7 % row.size()];
  const Shapes some = marks(shuffled);
  double least = 1e9, most = 0, last = 1e9;
  for (const ShapeVertex& vertex : some.inSpace) {
    const double away = -vertex.position.z;
    least = std::min(least, away);
    most = std::max(most, away);
    REQUIRE(away < last + 2);  // the width of a ring
    last = away;
  }
  CHECK(least < 2);
  CHECK(most > 57);
  CHECK(most < 62);
  // Marks fade towards the distance limit.
  CHECK(alpha(some.inSpace.front()) < 0.05);
  CHECK(alpha(some.inSpace[some.inSpace.size() / 2]) > 0.4);

  std::vector<Spot> many;
  for (int i = 0; i < 3000; ++i) many.push_back(spotAt({0.003 * i - 4, 1.6, -3.0 - 0.01 * i}));
  std::ranges::reverse(many);
  const std::size_t one = marks({many.back()}).inSpace.size();
  CHECK(marks(many).inSpace.size() <= one * kMaxMarks);
  CHECK(marks(many).inSpace.size() >= one * kMaxMarks / 3);
  for (const ShapeVertex& vertex : marks(many).inSpace) REQUIRE(vertex.position.z > -9);

  const Shapes plain = marks({row[2]}), pointed = marks({row[2]}, 0);
  REQUIRE(plain.inSpace.size() == pointed.inSpace.size());
  CHECK(alpha(pointed.inSpace.front()) > alpha(plain.inSpace.front()) + 0.2);
  CHECK(pointed.inSpace.front().colour != plain.inSpace.front().colour);
  CHECK((marks({row[2]}, 5).inSpace.front().colour == plain.inSpace.front().colour));
  // A pointed-at mark is visible also near the limit.
  CHECK(alpha(marks({row[14]}, 0).inSpace.front()) > 0.9);
}

TEST_CASE("shapes: marks fade near the eye, and far marks keep a minimum size") {
  const Shapes here = marks({spotAt({0, 1.7, 0})});
  double most = 0;
  for (const ShapeVertex& vertex : here.inSpace)
    if (vertex.position.y > 1) most = std::max(most, alpha(vertex));
  CHECK(most == 0);
  const Shapes child = marks({spotAt({0, 1.6, 0})}, std::nullopt, {}, {{0, 0.3, 0}, {1, 0, 0, 0}});
  for (const ShapeVertex& vertex : child.inSpace)
    if (vertex.position.y < 1) REQUIRE(alpha(vertex) == 0);
  double reach = 0;
  for (const ShapeVertex& vertex : marks({spotAt({0, 1.6, -50})}).inSpace)
    reach = std::max(reach, std::abs(double(vertex.position.x)));
  CHECK(reach > 0.5);
}

TEST_CASE("shapes: vertices are finite at any origin, scale and up, also with invalid spots") {
  AnyTracking any(41);
  for (const double far : {0.0, 1e7})
    for (int i = 0; i < 100; ++i) {
      const Tracking tracking = any.tracking(far, 6);
      const Pose head = any.head(), aim = any.head();
      std::vector<Spot> spots;
      for (int k = 0; k < 20; ++k) spots.push_back(spotAt(inWorld(tracking, any.between(0, 30) * any.unit())));
      spots.push_back(spotAt(glm::dvec3(kNaN)));
      spots.push_back(spotAt(glm::dvec3(1e300)));
      spots.push_back(spotAt(inWorld(tracking, head.position)));
      Shapes shapes = marks(spots, 3, tracking, head);
      REQUIRE(isWhole(shapes.inSpace));
      REQUIRE(!shapes.inSpace.empty());
      addHand(shapes, aim);
      addRay(shapes, head, aim, any.between(0, 100), i % 2 == 0);
      addRay(shapes, aim, aim, 3, true);
      addRay(shapes, {aim.position + 2.0 * viewAxis(aim), head.rotation}, aim, 3, true);
      addRay(shapes, head, aim, kNaN, true);
      addRay(shapes, head, aim, 1e300, false);
      addFloorGrid(shapes, head);
      addProgressRing(shapes, head, any.between(-1, 2), 0);
      addProgressRing(shapes, head, std::nullopt, any.between(-1e9, 1e9));
      addProgressRing(shapes, head, kNaN, kNaN);
      REQUIRE(isWhole(shapes.inSpace));
      REQUIRE(shapes.onView.empty());
    }
}

TEST_CASE("shapes: a hand is a wand whose tip points along −z") {
  Shapes shapes;
  const Pose aim{{1, 1, 1}, glm::angleAxis(glm::half_pi<double>(), glm::dvec3(0, 1, 0))};  // −z is the world's −x
  addHand(shapes, aim);
  REQUIRE(isWhole(shapes.inSpace));
  CHECK(shapes.inSpace.size() == 12);
  int tips = 0;
  for (const ShapeVertex& vertex : shapes.inSpace) {
    tips += glm::distance(glm::dvec3(vertex.position), aim.position) < 1e-6;
    CHECK(vertex.position.x >= 1);
    CHECK(glm::distance(glm::dvec3(vertex.position), aim.position) < 0.2);
    CHECK(alpha(vertex) == 1);
  }
  CHECK(tips == 3);
}

TEST_CASE("shapes: a ray starts at the hand, has the given length and turns its broad side to the head") {
  AnyTracking any(42);
  for (int i = 0; i < 100; ++i) {
    const Pose head = any.head(), aim = any.head();
    Shapes shapes;
    addRay(shapes, head, aim, 5, true);
    REQUIRE(shapes.inSpace.size() == 6);
    const glm::dvec3 end = aim.position + 5.0 * viewAxis(aim);
    for (const ShapeVertex& vertex : shapes.inSpace) {
      const glm::dvec3 at(vertex.position);
      REQUIRE(std::min(glm::distance(at, aim.position), glm::distance(at, end)) < 0.01);
      REQUIRE(alpha(vertex) > 0.5);
    }
    const glm::dvec3 a(shapes.inSpace[0].position), b(shapes.inSpace[1].position), c(shapes.inSpace[2].position);
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    const glm::dvec3 to = head.position - aim.position, along = viewAxis(aim);
    const glm::dvec3 facing = to - glm::dot(to, along) * along;
    if (glm::length(facing) > 0.3) REQUIRE(std::abs(glm::dot(glm::normalize(normal), glm::normalize(facing))) > 0.999);
  }
  Shapes none;
  addRay(none, kHead, kHead, 0, true);
  addRay(none, kHead, kHead, -3, true);
  addRay(none, kHead, kHead, kNaN, true);
  CHECK(none.inSpace.empty());
  Shapes fading;
  addRay(fading, kHead, {{0.2, 1.2, -0.3}, {1, 0, 0, 0}}, 4, false);
  for (const ShapeVertex& vertex : fading.inSpace) CHECK((alpha(vertex) > 0) == (vertex.position.z > -1));
}

TEST_CASE("shapes: a ray ends at its target") {
  const Tracking tracking = levelTracking({0, 1, 0}, 3);
  const Spot spot = spotAt(inWorld(tracking, glm::dvec3(0, 1.6, -4)));
  const glm::dvec3 hand(0, 1.2, 0);
  const auto aim = [&](glm::dvec3 at) {
    const glm::dvec3 to = glm::normalize(at - hand);
    return Pose{hand, glm::normalize(glm::dquat(1 - to.z, glm::cross(glm::dvec3(0, 0, -1), to)))};
  };
  CHECK(rayLength(spot, tracking, aim({0, 1.6, -4}), 1.6) == Approx(std::hypot(4, 0.4)));
  CHECK(rayLength(spot, tracking, aim({0, 0, -4}), 1.6) == Approx(std::hypot(4, 1.2)));
  CHECK(std::isfinite(rayLength(spotAt(inWorld(tracking, hand)), tracking, aim({0, 0, -4}), 0)));
}

TEST_CASE("shapes: the floor grid lies at the feet, fades out, and stays in place while the head moves") {
  const auto isLine = [](double at) { return std::abs(at - 0.5 * std::round(2 * at)) < 0.0061; };
  double most = 0, last = 0;
  for (double x = -0.6; x < 0.6; x += 0.01) {
    Shapes shapes;
    addFloorGrid(shapes, {{x, 1.7, -7.1}, {1, 0, 0, 0}});
    REQUIRE(isWhole(shapes.inSpace));
    double brightness = 0;
    for (const ShapeVertex& vertex : shapes.inSpace) {
      REQUIRE(vertex.position.y == 0);
      REQUIRE((isLine(vertex.position.x) || isLine(vertex.position.z)));
      const double away = std::hypot(vertex.position.x - x, vertex.position.z + 7.1);
      REQUIRE(away < 6.1);
      if (away > 5.9) REQUIRE(alpha(vertex) < 0.02);
      most = std::max(most, alpha(vertex));
      brightness += alpha(vertex);
    }
    if (last > 0) CHECK(std::abs(brightness / last - 1) < 0.01);  // nothing appears suddenly
    last = brightness;
  }
  CHECK(most > 0.6);
}

TEST_CASE("shapes: the progress ring fills clockwise from the top, in front of the head") {
  const Pose head{{1, 1.7, 2}, glm::angleAxis(0.8, glm::dvec3(0, 1, 0))};
  const auto filled = [&](std::optional<double> progress, double seconds = 0) {
    Shapes base, shapes;
    addProgressRing(base, head, 0, 0);
    addProgressRing(shapes, head, progress, seconds);
    std::vector<glm::dvec2> points;  // relative to the ring's middle, towards the head's right and up
    const glm::dvec3 right = head.rotation * glm::dvec3(1, 0, 0);
    const glm::dvec3 middle = glm::dvec3(1, 1, 2) + 2.0 * (head.rotation * glm::dvec3(0, 0, -1));
    for (std::size_t i = base.inSpace.size(); i < shapes.inSpace.size(); ++i) {
      const glm::dvec3 at = glm::dvec3(shapes.inSpace[i].position) - middle;
      REQUIRE(std::abs(glm::dot(at, head.rotation * glm::dvec3(0, 0, 1))) < 1e-6);
      points.push_back({glm::dot(at, right), at.y});
    }
    return points;
  };
  CHECK(filled(0).empty());
  CHECK(filled(-2).empty());
  const auto quarter = filled(0.25), half = filled(0.5), all = filled(1), more = filled(3);
  REQUIRE(!quarter.empty());
  CHECK(std::ranges::all_of(quarter, [](glm::dvec2 p) { return p.x > -1e-6 && p.y > -1e-6; }));
  CHECK(std::ranges::all_of(half, [](glm::dvec2 p) { return p.x > -1e-6; }));
  CHECK(std::ranges::any_of(half, [](glm::dvec2 p) { return p.y < -0.13; }));
  CHECK(std::ranges::any_of(all, [](glm::dvec2 p) { return p.x < -0.13; }));
  CHECK((all == more));
  // Unknown progress: a rotating quarter.
  CHECK((filled(std::nullopt, 0) != filled(std::nullopt, 0.3)));
  CHECK((filled(std::nullopt, 0) == filled(kNaN, 0)));
  CHECK(std::ranges::all_of(filled(std::nullopt, 0), [](glm::dvec2 p) { return p.x > -1e-6 && p.y > -1e-6; }));
}

TEST_CASE("shapes: colours are packed bytes, red in the lowest") {
  Shapes shapes;
  addRay(shapes, kHead, {{0.2, 1.2, -0.3}, {1, 0, 0, 0}}, 4, true);  // amber
  const std::uint32_t colour = shapes.inSpace.front().colour;
  CHECK((colour & 255) == 255);
  CHECK((colour >> 8 & 255) == 204);
  CHECK((colour >> 16 & 255) == 64);
  CHECK(colour >> 24 == 242);
  CHECK(sizeof(ShapeVertex) == 16);
}
