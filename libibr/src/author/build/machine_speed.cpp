// SPDX-License-Identifier: Apache-2.0
#include "author/build/machine_speed.h"

#include <algorithm>
#include <vector>

#include "author/match/match.h"
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "base/usage.h"
#include "scene/synth/synthetic.h"

namespace ibr {
namespace {

constexpr double kReferenceSeconds = 0.0151;  // s of processor time for one match, on the machine of the constants
constexpr double kLongEnough = 0.25;          // min duration, s
constexpr std::size_t kLeast = 2;             // min matches per thread; the first one also warms the caches

struct Pair {
  std::vector<MatchView> views;
  std::vector<glm::dvec3> points;
};

Pair generatedPair() {
  SyntheticOptions options;
  const Intrinsics k = pinholeFromFov(160, 120, 0.8);
  options.cameras = {{k, {{-0.2, 0, 0}, {1, 0, 0, 0}}}, {k, {{0.2, 0, 0}, {1, 0, 0, 0}}}};
  options.planes = {{{0, 0, -4}, {1, 0, 0}, {0, 1, 0}, 8, 6, 1, 0.1},
                    {{0.3, 0, -3}, {1, 0, 0}, {0, 1, 0}, 1, 1, 2, 0.1}};
  options.gridStep = 160;  // the generated mesh is unused
  options.samplesPerAxis = 1;
  SyntheticScene scene = makeScene(options);
  Pair pair;
  for (std::size_t i = 0; i < 2; ++i) pair.views.push_back({options.cameras[i], std::move(scene.photographs[i])});
  for (int i = 0; i < 40; ++i) pair.points.push_back({0.05 * i - 1, 0.03 * (i % 7), i % 2 ? -4 : -3});
  return pair;
}

}  // namespace

MachineSpeed measureSpeed(int threads) {
  const Pair pair = generatedPair();
  struct Taken {
    double processor = 0, passing = 0;
    std::size_t matches = 0;
  };
  std::vector<Taken> taken(std::size_t(std::max(threads, 1)));
  runJobs(
      taken.size(), int(taken.size()),
      [&](std::size_t t) {
        matchViews(pair.views, pair.points);
        const Stopwatch watch;
        const double before = threadSeconds();
        while (taken[t].matches < kLeast || watch.seconds() < kLongEnough) {
          matchViews(pair.views, pair.points);
          ++taken[t].matches;
        }
        taken[t].processor = threadSeconds() - before;
        taken[t].passing = watch.seconds();
      },
      [](std::size_t) { return true; });
  Taken all;
  for (const Taken& t : taken) {
    all.processor += t.processor / double(t.matches);
    all.passing += t.passing / double(t.matches);
  }
  const double count = double(taken.size()) * kReferenceSeconds;
  return {all.processor / count, all.passing / count};
}

}  // namespace ibr
