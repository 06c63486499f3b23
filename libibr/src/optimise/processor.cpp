// SPDX-License-Identifier: Apache-2.0
#include "optimise/processor.h"

#include "optimise/workers.h"

namespace ibr {
namespace {

void moveClass(const BackendInput& input, std::span<const std::uint32_t> points, std::size_t member, Positions& at,
               const PickBest& best, CycleCounts& counts) {
  std::vector<Pick> picks(points.size());
  forEachInParallel(points.size(), input.options.threads,
                    [&](std::size_t i) { picks[i] = best(points[i], member, at); });
  std::vector<Moved> moved;
  for (std::size_t i = 0; i < points.size(); ++i) {
    counts.mutations += picks[i].mutations;
    counts.pixels += picks[i].pixels;
    if (picks[i].offset == glm::ivec2(0)) continue;
    moved.push_back({points[i], at[member][points[i]]});
    at[member][points[i]] += picks[i].offset;
  }
  applyGuard(input.options.guard, moved, member, at, counts);
}

}  // namespace

CycleCounts runCycleOnCpu(const BackendInput& input, Positions& at, const KeepGoing& keepGoing, const PickBest& best) {
  CycleCounts counts;
  for (std::size_t member = 0; member < at.size(); ++member)
    for (std::size_t c = 0; c + 1 < input.mesh.colours.first.size(); ++c) {
      moveClass(input, input.mesh.colours[c], member, at, best, counts);
      keepGoing();
    }
  return counts;
}

std::vector<Judgement> judgeAllOnCpu(const BackendInput& input, const Positions& at) {
  const std::size_t n = input.mesh.vertexCount();
  std::vector<Judgement> all(at.size() * n);
  forEachInParallel(all.size(), input.options.threads, [&](std::size_t i) {
    all[i] = judge({input.mesh, input.pictures}, at, std::uint32_t(i % n), i / n, glm::ivec2(0));
  });
  return all;
}

}  // namespace ibr
