// SPDX-License-Identifier: Apache-2.0
// Values of photographs for the gather, and the choice of the best set, against plain implementations.
#include "render/photographs/photograph_set.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <random>

#include "shared/gather.h"
#include "support/without_avx2.h"

using namespace ibr;

namespace {

Camera cameraAt(glm::dvec3 position, glm::dquat rotation = glm::dquat(1, 0, 0, 0)) {
  return {pinholeFromFov(640, 480, 1.0), {position, rotation}};
}

// The definition, in double precision.
double valueOf(const Camera& photograph, const Pose& middle, glm::dvec3 ray, double nearness) {
  const glm::dquat toPhotograph = glm::conjugate(photograph.pose.rotation);
  const glm::dvec3 turned = toPhotograph * (middle.rotation * ray);
  const glm::dvec3 direction = turned + nearness * (toPhotograph * (middle.position - photograph.pose.position));
  double border = 1;
  const Intrinsics& k = photograph.intrinsics;
  if (k.model == CameraModel::pinhole) {
    const auto pixel = project(k, direction);
    if (!pixel) return 0;
    const double inside = std::min(std::min(pixel->x, k.width - pixel->x), std::min(pixel->y, k.height - pixel->y));
    border = std::clamp(inside / (double(shader::kGatherBorder) * k.width), 0.0, 1.0);
  }
  return border / (double(shader::kGatherAngleFloor) +
                   std::atan2(glm::length(glm::cross(turned, direction)), glm::dot(turned, direction)));
}

struct Pool {
  std::vector<SampleValues> values;
  std::vector<const SampleValues*> pointers;
};

Pool poolOf(std::mt19937_64& random, std::size_t size, bool alike) {
  std::uniform_real_distribution<double> unit(-1, 1);
  const std::vector<Camera> views{cameraAt({0, 0, 0})};
  const SampleRays rays = sampleRays(views, views[0].pose);
  Pool pool;
  for (std::size_t i = 0; i < size; ++i) {
    const glm::dvec3 at = (alike ? 0.2 : 3.0) * glm::dvec3(unit(random), unit(random), unit(random));
    const glm::dquat turn = glm::angleAxis((alike ? 0.1 : 1.2) * unit(random), glm::dvec3(0, 1, 0));
    pool.values.push_back(photographValues(cameraAt(at, turn), views[0].pose, rays, 0.2));
    if (i % 9 == 8) pool.values.back() = pool.values[i / 2];  // equal photographs
  }
  for (const SampleValues& one : pool.values) pool.pointers.push_back(&one);
  return pool;
}

// The same algorithm, in which every gain of every step is computed.
std::vector<SetMember> plainSet(const Pool& pool, std::size_t count) {
  const std::size_t n = pool.values.size();
  std::vector<std::size_t> members;
  const auto taken = [&](std::size_t i) { return std::ranges::find(members, i) != members.end(); };
  const auto sumWithout = [&](std::size_t left) {
    SampleValues sum;
    for (std::size_t m = 0; m < members.size(); ++m)
      if (m != left) add(sum, pool.values[members[m]]);
    return sum;
  };
  const auto best = [&](const SampleValues& others, float above) {
    std::optional<std::size_t> found;
    for (std::size_t i = 0; i < n; ++i)
      if (const float with = coverage(others, pool.values[i]); !taken(i) && with > above) above = with, found = i;
    return std::pair(found, above);
  };
  SampleValues sum;
  while (members.size() < std::min(count, n)) {
    const auto [next, with] = best(sum, coverage(sum));
    if (!next) break;
    members.push_back(*next);
    add(sum, pool.values[*next]);
  }
  std::vector<float> weight(members.size(), 1.0f);
  if (members.size() < n) {
    for (std::size_t round = 0; round < 2 * members.size(); ++round) {
      float most = 0;
      std::optional<std::size_t> outgoing, incoming;
      for (std::size_t m = 0; m < members.size(); ++m) {
        const SampleValues others = sumWithout(m);
        const float here = coverage(others, pool.values[members[m]]);
        const auto [other, with] = best(others, coverage(others));
        if (!other || !(with - here > std::max(most, 1e-6f * here))) continue;
        most = with - here;
        outgoing = m;
        incoming = other;
      }
      if (!incoming) break;
      members[*outgoing] = *incoming;
    }
    for (std::size_t m = 0; m < members.size(); ++m) {
      const SampleValues others = sumWithout(m);
      const float base = coverage(others), loss = coverage(others, pool.values[members[m]]) - base;
      const float gain = best(others, base).second - base;
      if (gain > 0) weight[m] = std::clamp((loss / gain - 1) / 0.25f, 0.0f, 1.0f);
    }
  }
  std::vector<SetMember> result;
  for (std::size_t m = 0; m < members.size(); ++m) result.push_back({members[m], weight[m]});
  std::ranges::sort(result, {}, &SetMember::photograph);
  return result;
}

}  // namespace

TEST_CASE("values in single precision are those in double precision, for pinholes and panoramas") {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto turn = [&] {
    return glm::normalize(glm::dquat(1 + unit(random), unit(random), unit(random), unit(random)));
  };
  for (int repeat = 0; repeat < 50; ++repeat) {
    const std::vector<Camera> views{cameraAt({1, 2, 3}, turn())};
    const Pose& middle = views[0].pose;
    const SampleRays rays = sampleRays(views, middle);
    const double near = repeat % 5 == 4 ? 0 : 0.3;
    for (const glm::dvec3 offset :
         {glm::dvec3(0), glm::dvec3(0.3, 0.1, -0.2), glm::dvec3(-5, 2, 9), glm::dvec3(1e9, 0, 0)}) {
      Camera photograph = cameraAt(middle.position + offset, turn());
      if (offset == glm::dvec3(0)) photograph.pose.rotation = middle.rotation;
      if (repeat % 3 == 0) photograph.intrinsics = {CameraModel::equirectangular, 640, 320, 0, 0, 0, 0};
      const SampleValues values = photographValues(photograph, middle, rays, near);
      for (std::size_t p = 0; p < kSamplePoints; ++p) {
        const glm::dvec3 ray(rays.x[p % kSampleRays], rays.y[p % kSampleRays], -1);
        const double expected = valueOf(photograph, middle, ray, near * kSampleDepths[p / kSampleRays]);
        REQUIRE(double(values.at[p]) == Approx(expected).epsilon(1e-3).margin(2e-3));
      }
    }
  }
}

TEST_CASE("the inner loops give the same bits with and without AVX2") {
  const auto results = [](const Pool& pool) {
    SampleValues sum = pool.values[0], weights = pool.values[1];
    add(sum, pool.values[1]);
    toGatherWeights(weights, 2.5, 0.7f);
    std::vector<double> shares(pool.values.size());
    gatherShares(pool.values, shares);
    shares.push_back(double(coverage(sum)));
    shares.push_back(double(coverage(sum, pool.values[2])));
    shares.push_back(double(linear(coverageSlopes(sum), pool.values[2])));
    shares.insert(shares.end(), weights.at.begin(), weights.at.end());
    return shares;
  };
  const auto compute = [&] {
    std::mt19937_64 random(4);
    return results(poolOf(random, 8, false));
  };
  CHECK(test::withoutAvx2(compute) == compute());
}

TEST_CASE("the set is that of computing every gain") {
  std::mt19937_64 random(6);
  std::size_t exchanged = 0, faded = 0;
  for (int repeat = 0; repeat < 60; ++repeat) {
    const Pool pool =
        poolOf(random, std::array<std::size_t, 4>{1, 9, 40, 64}[std::size_t(repeat % 4)], repeat % 3 == 0);
    for (const std::size_t count : {1u, 5u, 12u, 16u}) {
      const std::vector<SetMember> plain = plainSet(pool, count);
      const auto set = bestSet(pool.pointers, count, std::pmr::get_default_resource());
      REQUIRE(set.size() == plain.size());
      for (std::size_t m = 0; m < set.size(); ++m) {
        CHECK(set[m].photograph == plain[m].photograph);
        CHECK(set[m].weight == plain[m].weight);
        faded += set[m].weight < 1;
        exchanged += set[m].photograph >= count;
      }
    }
  }
  CHECK(exchanged > 100);
  CHECK(faded > 100);
}

TEST_CASE("slopes bound the coverage of any other values") {
  std::mt19937_64 random(9);
  const Pool pool = poolOf(random, 20, false);
  for (std::size_t i = 0; i + 1 < 20; ++i) {
    const SampleValues &a = pool.values[i], &b = pool.values[i + 1];
    const CoverageSlopes slopes = coverageSlopes(a);
    CHECK(coverage(b) <= coverage(a) + linear(slopes, b) - linear(slopes, a) + 1e-3f);
    CHECK(coverage(a) == Approx(2 * linear(slopes, a)));
  }
}

TEST_CASE("no pool, an empty set and photographs that show nothing give no members") {
  const std::vector<SampleValues> none(3);
  const std::vector<const SampleValues*> pool{&none[0], &none[1], &none[2]};
  CHECK(bestSet({}, 12, std::pmr::get_default_resource()).empty());
  CHECK(bestSet(pool, 0, std::pmr::get_default_resource()).empty());
  CHECK(bestSet(pool, 12, std::pmr::get_default_resource()).empty());
}
