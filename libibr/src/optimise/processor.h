// SPDX-License-Identifier: Apache-2.0
// What methods on the processor share: classes one after another, the points of a class side by side. Nothing that one
// of them reads is moved by another, so the result does not depend on the number of threads.
#pragma once

#include <functional>

#include "optimise/mover.h"

namespace ibr {

/// What became of a point in one picture.
struct Pick {
  glm::ivec2 offset{0};  // by which it moves
  std::uint64_t mutations = 0, pixels = 0;
};

/// `best` is called from several threads; `at` stands still meanwhile.
using PickBest = std::function<Pick(std::uint32_t point, std::size_t member, const Positions& at)>;

CycleCounts cycleOnProcessor(const MoverInput& input, Positions& at, const KeepGoing& keepGoing, const PickBest& best);

/// Mover::judgeAll.
std::vector<Judgement> judgeAllOnProcessor(const MoverInput& input, const Positions& at);

}  // namespace ibr
