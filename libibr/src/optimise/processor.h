// SPDX-License-Identifier: Apache-2.0
// Shared by the methods on the CPU: classes run one after another, the points of a class in parallel. No point of a
// class moves a star of another, so the result does not depend on the number of threads.
#pragma once

#include <functional>

#include "optimise/alignment_backend.h"

namespace ibr {

/// Result for a point in one image.
struct Pick {
  glm::ivec2 offset{0};  // displacement of the point
  std::uint64_t mutations = 0, pixels = 0;
};

/// `best` is called from several threads; `at` does not change during the calls.
using PickBest = std::function<Pick(std::uint32_t point, std::size_t member, const Positions& at)>;

CycleCounts runCycleOnCpu(const BackendInput& input, Positions& at, const KeepGoing& keepGoing, const PickBest& best);

/// Implements AlignmentBackend::judgeAll.
std::vector<Judgement> judgeAllOnCpu(const BackendInput& input, const Positions& at);

}  // namespace ibr
