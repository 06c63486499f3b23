// SPDX-License-Identifier: Apache-2.0
// Chooses the photographs that a frame votes and gathers with (Composition::gathered, hybrid).
//
// The set S of K photographs should cover the view best: F(S) = Σ √(Σ_S value), over a grid of rays and two depths
// (photograph_values.h). Of the most promising photographs (photograph_index.h), those that cover most alone form a
// pool. A greedy choice from the pool is followed by exchanges until none improves F; greedy ranks alone jump where two
// photographs take turns. A member has weight 0 if an outsider would do as well in its place. The weight grows to 1, so
// that photographs fade in and out.
#pragma once

#include <cstddef>
#include <memory_resource>
#include <stop_token>
#include <vector>

#include "ibr/frame_plan.h"
#include "render/photographs/photograph_index.h"

namespace ibr {

/// Indices of the scene's backdrops that can be gathered from: with evidence in the mesh and a depth texture.
std::vector<std::uint32_t> gatherableBackdrops(const Scene& scene);

/// Number of the most promising photographs that are evaluated, and of those that take part in the choice.
inline constexpr std::size_t kMaxPromising = 96;
inline constexpr std::size_t kMaxPoolSize = 64;

/// Overwrites `chosen` with at most `count` photographs, best first. PlannedPhotograph::share is each photograph's
/// share of the views' colours if the gather blends the best four; exposure adapts with these shares. `middle`: pose
/// between the views. `memory` is used for the call. Does not depend on the order of the scene's photographs, except
/// among photographs of equal poses.
void choosePhotographs(const Scene& scene, const PhotographIndex& index, const GatherStatistics& statistics,
                       const std::vector<Camera>& views, const Pose& middle, std::size_t count,
                       std::pmr::memory_resource* memory, std::vector<PlannedPhotograph>& chosen);

/// GatherStatistics of a scene.
GatherStatistics gatherStatistics(const Scene& scene, const std::stop_token& stop = {});

}  // namespace ibr
