// SPDX-License-Identifier: Apache-2.0
// Barycentric weights against exact rationals computed from the stored doubles.
#include "render/plan/barycentric.h"

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <random>
#include <vector>

#include "support/without_avx2.h"

using namespace ibr;
using Rational = boost::multiprecision::cpp_rational;

namespace {

struct Exact {
  Rational x, y, z;
  explicit Exact(glm::dvec3 v) : x(v.x), y(v.y), z(v.z) {}
  Exact(Rational a, Rational b, Rational c) : x(std::move(a)), y(std::move(b)), z(std::move(c)) {}
  friend Exact operator-(const Exact& a, const Exact& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Rational dot(const Exact& a, const Exact& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
};

// Exact λ: normal equations of the edges, solved by Cramer's rule.
std::vector<double> exactWeights(const std::vector<glm::dvec3>& corners, glm::dvec3 p) {
  const std::size_t n = corners.size() - 1;
  const Exact origin(corners[0]);
  std::vector<Exact> edges;
  for (std::size_t i = 1; i <= n; ++i) edges.push_back(Exact(corners[i]) - origin);
  const Exact w = Exact(p) - origin;
  std::vector<std::vector<Rational>> m(n, std::vector<Rational>(n + 1));
  for (std::size_t r = 0; r < n; ++r) {
    for (std::size_t c = 0; c < n; ++c) m[r][c] = dot(edges[r], edges[c]);
    m[r][n] = dot(edges[r], w);
  }
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    while (pivot < n && m[pivot][k] == 0) ++pivot;
    REQUIRE(pivot < n);
    std::swap(m[k], m[pivot]);
    for (std::size_t r = 0; r < n; ++r)
      if (r != k) {
        const Rational factor = m[r][k] / m[k][k];
        for (std::size_t c = k; c <= n; ++c) m[r][c] -= factor * m[k][c];
      }
  }
  std::vector<double> weights(1);
  Rational rest = 1;
  for (std::size_t i = 0; i < n; ++i) {
    const Rational value = m[i][n] / m[i][i];
    rest -= value;
    weights.push_back(value.convert_to<double>());
  }
  weights[0] = rest.convert_to<double>();
  return weights;
}

double sum(const Weights& w) {
  return w[0] + w[1] + w[2] + w[3];
}

glm::dvec3 pointOf(const std::vector<glm::dvec3>& corners, const Weights& weights) {
  glm::dvec3 p(0.0);
  for (std::size_t i = 0; i < corners.size(); ++i) p += weights[i] * (corners[i] - corners[0]);
  return corners[0] + p;
}

}  // namespace

TEST_CASE("weights are exact to rounding, in small and large worlds", "[N5][T9][P5]") {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  auto vector = [&] { return glm::dvec3(unit(random), unit(random), unit(random)); };
  double worst = 0;
  for (double offset : {0.0, 1e3, 5e5, 6.4e6, 1e7})
    for (double size : {1e-3, 1.0, 50.0, 1e4})
      for (std::size_t d : {2u, 3u, 4u})
        for (int repeat = 0; repeat < 10; ++repeat) {
          std::vector<glm::dvec3> corners;
          for (std::size_t i = 0; i < d; ++i) corners.push_back(offset * glm::dvec3(0.3, -0.5, 0.8) + size * vector());
          const glm::dvec3 p = corners[0] + size * vector();
          const Barycentric b = barycentric(corners, p);
          REQUIRE_FALSE(b.degenerate);
          const std::vector<double> expected = exactWeights(corners, p);
          // Coordinates are rounded at `offset`; a simplex as thin as the rounding is a sliver, tested below.
          double largest = 1;
          for (double e : expected) largest = std::max(largest, std::abs(e));
          for (std::size_t i = 0; i < d; ++i) worst = std::max(worst, std::abs(b.free[i] - expected[i]) / largest);
          CHECK(std::abs(sum(b.free) - 1) <= 4e-16 * largest);
          CHECK(std::abs(sum(b.clamped) - 1) <= 4.5e-16);
        }
  CHECK(worst <= 1e-14);
}

TEST_CASE("weights of slivers are accurate where a matrix inverse is not", "[N5][T9]") {
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> unit(0.1, 0.9);
  for (double height : {1e-2, 1e-5, 1e-8}) {
    const glm::dvec3 o(5e5, 4.2e6, 250);
    // Heights are multiples of the coordinates' rounding unit, so that differences are exact.
    const double h = std::max(std::round(height / 9.5e-10), 1.0) * 9.313225746154785e-10;
    const std::vector<glm::dvec3> triangle{o, o + glm::dvec3(1, 0, 0), o + glm::dvec3(0.5, h, 0)};
    const std::vector<glm::dvec3> tetrahedron{o, o + glm::dvec3(1, 0, 0), o + glm::dvec3(0, 0, 1),
                                              o + glm::dvec3(0.25, h, 0.25)};
    for (const auto& corners : {triangle, tetrahedron}) {
      const glm::dvec3 p = o + glm::dvec3(unit(random), 0.5 * h, 0.25 * unit(random));
      const Barycentric b = barycentric(corners, p);
      REQUIRE_FALSE(b.degenerate);
      const std::vector<double> expected = exactWeights(corners, p);
      for (std::size_t i = 0; i < corners.size(); ++i)
        CHECK(b.free[i] == Approx(expected[i]).margin(1e-13).epsilon(1e-13));
    }
  }
}

TEST_CASE("the clamped point is the closest one", "[N5][P5]") {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  auto vector = [&] { return glm::dvec3(unit(random), unit(random), unit(random)); };
  for (std::size_t d : {1u, 2u, 3u, 4u})
    for (int repeat = 0; repeat < 300; ++repeat) {
      std::vector<glm::dvec3> corners;
      for (std::size_t i = 0; i < d; ++i) corners.push_back(vector());
      const glm::dvec3 p = (repeat % 3 == 0 ? 0.3 : 3.0) * vector();
      const Barycentric b = barycentric(corners, p);
      for (std::size_t i = 0; i < 4; ++i) {
        CHECK(b.clamped[i] >= 0.0);
        CHECK((i < d || b.clamped[i] == 0.0));
      }
      const glm::dvec3 closest = pointOf(corners, b.clamped);
      CHECK(glm::distance(closest, p) == Approx(b.distance).margin(1e-12));
      // Closest point of a convex set: no corner is on p's side of the plane through the point, normal to p − point.
      for (const glm::dvec3& corner : corners) CHECK(glm::dot(p - closest, corner - closest) <= 1e-12);
    }
}

TEST_CASE("points on corners, edges, faces and inside have distance 0", "[N5]") {
  const std::vector<glm::dvec3> corners{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}};
  for (const Weights& w : {Weights{1, 0, 0, 0}, Weights{0, 0, 1, 0}, Weights{0.5, 0.5, 0, 0}, Weights{0, 0.25, 0.75, 0},
                           Weights{0.5, 0.25, 0.25, 0}, Weights{0.25, 0.25, 0.25, 0.25}}) {
    const Barycentric b = barycentric(corners, pointOf(corners, w));
    CHECK(b.distance <= 1e-15);
    for (std::size_t i = 0; i < 4; ++i) CHECK(b.clamped[i] == Approx(w[i]).margin(1e-15));
  }
}

TEST_CASE("degenerate simplices are reduced to a lower dimension and reported", "[N5][T9]") {
  const glm::dvec3 a(1e5, 2, 3), p = a + glm::dvec3(0.25, 0.5, -1);
  const glm::dvec3 e(1, 0, 0);
  for (const std::vector<glm::dvec3>& corners :
       {std::vector{a, a}, std::vector{a, a, a}, std::vector{a, a + e, a + 2.0 * e}, std::vector{a, a, a + e},
        std::vector{a, a + e, a + 2.0 * e, a + 3.0 * e},
        std::vector{a, a + e, a + glm::dvec3(0, 1, 0), a + glm::dvec3(1, 1, 0)}, std::vector{a, a, a, a}}) {
    const Barycentric b = barycentric(corners, p);
    CHECK(b.degenerate);
    CHECK(sum(b.free) == Approx(1));
    CHECK(sum(b.clamped) == Approx(1));
    CHECK(std::isfinite(b.distance));
    CHECK(glm::distance(pointOf(corners, b.clamped), p) == Approx(b.distance));
  }
  // Three collinear corners: the longest edge decides, so errors are not amplified.
  const Barycentric line = barycentric(std::vector{a, a + 0.125 * e, a + e}, p);
  CHECK(line.free[0] == 0.75);
  CHECK(line.free[1] == 0.0);
  CHECK(line.free[2] == 0.25);
}

TEST_CASE("smoothstepped weights sum to 1 and never vanish (T12)", "[N5][T12]") {
  std::mt19937_64 random(8);
  std::exponential_distribution<double> exponential;
  for (std::size_t d : {2u, 3u, 4u})
    for (int repeat = 0; repeat < 1000; ++repeat) {
      Weights w{};
      for (std::size_t i = 0; i < d; ++i) w[i] = exponential(random);
      const double total = sum(w);
      double steps = 0;
      for (double& x : w) {
        x /= total;
        steps += x * x * x * (x * (6 * x - 15) + 10);
      }
      CHECK(steps >= 0.41);
      CHECK(sum(smoothstep(w)) == Approx(1).epsilon(1e-15));
    }
  CHECK(smoothstep({1, 0, 0, 0}) == Weights{1, 0, 0, 0});
  CHECK(smoothstep({0.25, 0.25, 0.25, 0.25}) == Weights{0.25, 0.25, 0.25, 0.25});
  CHECK(smoothstep({0.9, 0.1, 0, 0})[0] > 0.98);  // biased towards fewer members
}

TEST_CASE("a millimetre cell at UTM coordinates has exact weights in double precision only", "[N5][T9]") {
  const glm::dvec3 o(500123.25, 4200321.5, 250);
  const std::vector<glm::dvec3> corners{o, o + glm::dvec3(1e-3, 0, 0), o + glm::dvec3(0, 1e-3, 0),
                                        o + glm::dvec3(0, 0, 1e-3)};
  const glm::dvec3 p = o + glm::dvec3(3e-4, 2e-4, 1e-4);
  const std::vector<double> expected = exactWeights(corners, p);
  const Barycentric b = barycentric(corners, p);
  REQUIRE_FALSE(b.degenerate);
  for (std::size_t i = 0; i < 4; ++i) CHECK(b.free[i] == Approx(expected[i]).margin(1e-14));
  // [T] stores positions as floats: on the ground all corners round to one point.
  for (const glm::dvec3& corner : corners) CHECK((glm::vec2(corner) == glm::vec2(o)));
}

TEST_CASE("weights are bit-identical in both versions of the inner loop") {
  std::mt19937_64 random(13);
  std::uniform_real_distribution<double> unit(-1, 1);
  auto vector = [&] { return glm::dvec3(unit(random), unit(random), unit(random)); };
  for (const std::size_t d : {1u, 2u, 3u, 4u})
    for (int repeat = 0; repeat < 200; ++repeat) {
      std::vector<glm::dvec3> corners;
      for (std::size_t i = 0; i < d; ++i) corners.push_back(1e5 * glm::dvec3(0.3, -0.5, 0.8) + vector());
      if (repeat % 10 == 9) corners.back() = corners.front();  // degenerate
      const glm::dvec3 p = corners[0] + (repeat % 2 ? 0.3 : 3.0) * vector();
      const Barycentric widest = barycentric(corners, p);
      const Barycentric portable = test::withoutAvx2([&] { return barycentric(corners, p); });
      CHECK(portable.free == widest.free);
      CHECK(portable.clamped == widest.clamped);
      CHECK(portable.distance == widest.distance);
      CHECK(portable.degenerate == widest.degenerate);
    }
}

TEST_CASE("weights do not depend on the order of members, far outside too", "[N5]") {
  std::mt19937_64 random(12);
  std::uniform_real_distribution<double> unit(-1, 1);
  double worst = 0;
  for (const double away : {0.0, 1.0, 1e3, 1e6})
    for (int repeat = 0; repeat < 100; ++repeat) {
      std::vector<glm::dvec3> corners;
      for (int i = 0; i < 4; ++i) corners.emplace_back(unit(random), unit(random), unit(random));
      const glm::dvec3 p = corners[0] + away * glm::dvec3(unit(random), unit(random), unit(random));
      const Barycentric first = barycentric(corners, p);
      if (first.degenerate) continue;
      std::array<std::size_t, 4> order{0, 1, 2, 3};
      double largest = 1;
      for (const double w : first.free) largest = std::max(largest, std::abs(w));
      while (std::next_permutation(order.begin(), order.end())) {
        std::vector<glm::dvec3> other;
        for (const std::size_t i : order) other.push_back(corners[i]);
        const Barycentric b = barycentric(other, p);
        for (std::size_t i = 0; i < 4; ++i) {
          worst = std::max(worst, std::abs(b.free[i] - first.free[order[i]]) / largest);
          worst = std::max(worst, std::abs(b.clamped[i] - first.clamped[order[i]]));
        }
      }
    }
  CHECK(worst <= 1e-11);
}
