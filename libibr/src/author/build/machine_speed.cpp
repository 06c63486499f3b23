// SPDX-License-Identifier: Apache-2.0
#include "author/build/machine_speed.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "author/match/match.h"
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "base/usage.h"

namespace ibr {
namespace {

constexpr double kReferenceSeconds = 0.0143;  // s of cpu time for one match, on the machine of the constants
constexpr double kMinSeconds = 0.25;          // min duration, s
constexpr std::size_t kMinMatches = 2;        // min matches per thread; the first one also warms the caches

struct Pair {
  std::vector<MatchView> views;
  std::vector<glm::dvec3> points;
};

// Brightness of a texture with wavelengths of 0.1 to 0.4 world units.
double brightness(double x, double y) {
  double sum = 0;
  for (int i = 1; i <= 8; ++i) {
    const double turn = 2.4 * i, frequency = 2 * std::numbers::pi / (0.05 + 0.04 * i);
    sum += std::sin(frequency * (std::cos(turn) * x + std::sin(turn) * y) + turn);
  }
  return 128 + 25 * sum;
}

// A textured rectangle at z = −3 before a wall at z = −4. The camera looks along −z.
Image8 generatedPhotograph(const Camera& camera) {
  const Intrinsics& k = camera.intrinsics;
  Image8 picture(k.width, k.height, 3);
  for (int y = 0; y < k.height; ++y)
    for (int x = 0; x < k.width; ++x) {
      const glm::dvec3 ray = unproject(k, {x + 0.5, y + 0.5});
      const glm::dvec3 near = camera.pose.position - ray * (3 / ray.z), far = camera.pose.position - ray * (4 / ray.z);
      const bool isNear = std::abs(near.x - 0.3) < 0.5 && std::abs(near.y) < 0.5;
      const double level = isNear ? brightness(near.y, near.x) : brightness(far.x, far.y);
      std::ranges::fill(picture.pixel(x, y), std::uint8_t(std::clamp(level, 0.0, 255.0)));
    }
  return picture;
}

Pair generatedPair() {
  const Intrinsics k = pinholeFromFov(160, 120, 0.8);
  Pair pair;
  for (const double x : {-0.2, 0.2}) {
    const Camera camera{k, {{x, 0, 0}, {1, 0, 0, 0}}};
    pair.views.push_back({camera, generatedPhotograph(camera)});
  }
  for (int i = 0; i < 40; ++i) pair.points.push_back({0.05 * i - 1, 0.03 * (i % 7), i % 2 ? -4 : -3});
  return pair;
}

}  // namespace

MachineSpeed measureSpeed(int threads) {
  const Pair pair = generatedPair();
  struct MeasuredSeconds {
    double cpu = 0, elapsed = 0;
    std::size_t matches = 0;
  };
  std::vector<MeasuredSeconds> taken(std::size_t(std::max(threads, 1)));
  runJobs(
      taken.size(), int(taken.size()),
      [&](std::size_t t) {
        matchViews(pair.views, pair.points);
        const Stopwatch watch;
        const double before = threadSeconds();
        while (taken[t].matches < kMinMatches || watch.seconds() < kMinSeconds) {
          matchViews(pair.views, pair.points);
          ++taken[t].matches;
        }
        taken[t].cpu = threadSeconds() - before;
        taken[t].elapsed = watch.seconds();
      },
      [](std::size_t) { return true; });
  MeasuredSeconds all;
  for (const MeasuredSeconds& t : taken) {
    all.cpu += t.cpu / double(t.matches);
    all.elapsed += t.elapsed / double(t.matches);
  }
  const double count = double(taken.size()) * kReferenceSeconds;
  return {all.cpu / count, all.elapsed / count};
}

}  // namespace ibr
