// SPDX-License-Identifier: Apache-2.0
// Chooses the photographs that a frame votes and gathers with (Composition::gathered, hybrid).
//
// The set S of K photographs should cover the view best: F(S) = Σ √(Σ_S value), over a grid of rays and two depths,
// with value = border / (.03 + angle between the ray and the photograph's ray). A greedy choice is followed by
// exchanges until none improves F; greedy ranks alone jump where two photographs take turns. A member has weight 0 if
// an outsider would do as well in its place. The weight grows to 1, so that photographs fade in and out.
#pragma once

#include <cstddef>
#include <stop_token>
#include <vector>

#include "ibr/frame_plan.h"

namespace ibr {

/// Indices of the scene's backdrops that can be gathered from: with evidence in the mesh and a depth texture.
std::vector<std::uint32_t> gatherableBackdrops(const Scene& scene);

/// Returns at most `count` photographs, best first. PlannedPhotograph::share is each photograph's share of the views'
/// colours if the gather blends the best four; exposure adapts with these shares. `middle`: pose between the views.
/// Pure. Does not depend on the order of the scene's photographs, except among photographs of equal poses.
std::vector<PlannedPhotograph> choosePhotographs(const Scene& scene, const GatherStatistics& bounds,
                                                 const std::vector<Camera>& views, const Pose& middle,
                                                 std::size_t count);

/// GatherStatistics of a scene. A requested stop throws Error{cancelled}.
GatherStatistics gatherStatistics(const Scene& scene, const std::stop_token& stop = {});

}  // namespace ibr
