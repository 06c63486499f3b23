// SPDX-License-Identifier: Apache-2.0
// Questions to a posed model and its cameras, and leaving images of it out.
#pragma once

#include <string>
#include <vector>

#include "base/median.h"
#include "ibr/author.h"

namespace ibr {

/// Leaves images out, with their observations and the tracks that nobody else saw. Throws Error{invalidInput} for a
/// name that is not there.
void removeImages(PosedModel& model, const std::vector<std::string>& names);

/// Median distance between observations and projections of the tracks' points, px; 0 without tracks.
double reprojectionError(const PosedModel& model);

/// Median reprojection error up to which the poses of a model count as exact, px.
inline constexpr double kExactPx = 0.1;

/// Of each image the tracks that it observes, ascending; one that it observes twice is there once.
std::vector<std::vector<std::uint32_t>> tracksOfImages(const PosedModel& model);

/// Photographs are matched at no more pixels than this.
inline constexpr double kMatchPixels = 2e6;

/// The camera at the size that its photograph is matched at. Limits in px of what matching tells apart refer to it.
Camera matchedCamera(Camera camera);

}  // namespace ibr
