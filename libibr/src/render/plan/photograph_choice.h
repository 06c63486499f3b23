// SPDX-License-Identifier: Apache-2.0
// Photographs that a frame votes and gathers with (Composition::gathered, hybrid).
//
// The set S of K photographs is chosen that covers the view best, F(S) = Σ √(Σ_S value): over a grid of rays and two
// depths, value = border / (.03 + angle between the ray and the photograph's). Greedy, then exchanges until none is
// better: greedy ranks alone jump where two photographs take turns. A member's weight grows from 0, where an outsider
// would do as well in its place, to 1: no photograph comes or goes with a step.
#pragma once

#include <cstddef>
#include <vector>

#include "ibr/renderer.h"

namespace ibr {

/// Backdrops of the scene whose photographs can be gathered from: with evidence in the mesh and a depth texture.
std::vector<std::uint32_t> gatherableBackdrops(const Scene& scene);

/// At most `count` photographs, best first, with what they have of the views' colours as the gather would mix four of
/// them (PlannedPhotograph::share), which exposures are adapted by. `middle`: pose between the views. Pure; does not
/// depend on the order of the scene's photographs but among those of equal poses.
std::vector<PlannedPhotograph> choosePhotographs(const Scene& scene, const GatherBounds& bounds,
                                                 const std::vector<Camera>& views, const Pose& middle,
                                                 std::size_t count);

/// GatherBounds of a scene.
GatherBounds gatherBounds(const Scene& scene);

}  // namespace ibr
