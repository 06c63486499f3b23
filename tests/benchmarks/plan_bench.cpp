// SPDX-License-Identifier: Apache-2.0
// Time of planFrame along a walk, in CPU time of its thread: against the number of cells, against the size of meshes,
// and against the number of photographs of the gather. Scenes are generated in memory (tests/support/plan_scenes.h).
//
//   cmake --build build --target ibr_plan_bench && build/tests/benchmarks/ibr_plan_bench [frames] [largest cell count]
//   [part of a row's name]
#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "support/plan_scenes.h"

namespace {

using namespace ibr;

double threadSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

double quantile(const std::vector<double>& sorted, double share) {
  return sorted[std::min(sorted.size() - 1, std::size_t(share * double(sorted.size())))];
}

FrameInput inputOf(const test::PlanSceneShape& shape, int frame, bool stereo, const RenderSettings& settings) {
  FrameInput input{{}, settings, 1.0 / 60};
  if (!stereo) {
    input.views = {test::planWalk(shape, frame)};
    return input;
  }
  for (const double side : {-0.032, 0.032}) {
    Camera eye = test::planWalk(shape, frame, 2064, 2208);
    eye.pose.position += eye.pose.rotation * glm::dvec3(side, 0, 0);
    input.views.push_back(eye);
  }
  return input;
}

void measureWalks(std::string_view name, const test::PlanSceneShape& shape, const RenderSettings& settings,
                  int frames) {
  const Scene scene = test::makePlanScene(shape);
  const double before = threadSeconds();
  const SceneBounds bounds = sceneBounds(scene);
  const double boundsSeconds = threadSeconds() - before;
  for (const bool stereo : {false, true}) {
    std::vector<double> ms;
    double drawn = 0, photographs = 0, kept = 0;
    FramePlan plan;
    for (int frame = 0; frame < frames; ++frame) {
      const FrameInput input = inputOf(shape, frame, stereo, settings);
      const double start = threadSeconds();
      planFrame(scene, bounds, input, plan.next, plan);
      ms.push_back(1e3 * (threadSeconds() - start));
      drawn += double(plan.cells.size());
      photographs += double(plan.photographs.size());
      kept += double(plan.cells.size() + plan.next.hiddenCells.size());
    }
    std::ranges::sort(ms);
    fmt::print("{:22} {:>7} {:>6} {:7.3f} {:7.3f} {:7.3f} {:7.3f} {:7.1f} {:7.1f} {:6.1f} {:8.2f}\n", name,
               shape.quads ? test::cellCount(shape) : scene.backdrops.size(), stereo ? "stereo" : "mono",
               quantile(ms, 0.5), quantile(ms, 0.99), quantile(ms, 0.999), ms.back(), kept / frames, drawn / frames,
               photographs / frames, boundsSeconds);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int frames = argc > 1 ? std::atoi(argv[1]) : 2000, most = argc > 2 ? std::atoi(argv[2]) : 200000;
  const std::string_view part = argc > 3 ? argv[3] : "";
  const auto measure = [&](std::string_view name, const test::PlanSceneShape& shape, const RenderSettings& settings) {
    if (name.find(part) != name.npos && int(test::cellCount(shape)) <= most)
      measureWalks(name, shape, settings, frames);
  };
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  fmt::print("{:22} {:>7} {:>6} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7} {:>6} {:>8}\n", "ms of planFrame", "scene", "views",
             "p50", "p99", "p99.9", "max", "in view", "drawn", "photos", "bounds s");
  RenderSettings cells, gathered, hybrid;
  gathered.composition = Composition::gathered;
  hybrid.composition = Composition::hybrid;
  for (const int side : {6, 17, 51, 159}) measure("cells", {side, side}, cells);
  measure("cells, small meshes", {3, 3, 5, 8}, cells);
  measure("cells, large meshes", {3, 3, 5, 160}, cells);
  for (const int side : {2, 5, 16, 50}) measure("gathered", {side, side, side == 2 ? 5 : 8, 0, true}, gathered);
  measure("hybrid", {51, 51, 4, 2, true}, hybrid);
  return 0;
}
