// SPDX-License-Identifier: Apache-2.0
// Questions to a posed model, and leaving images of it out.
#pragma once

#include <string>
#include <vector>

#include "ibr/author.h"

namespace ibr {

/// Leaves images out, with their observations and the tracks that nobody else saw. Throws Error{invalidInput} for a
/// name that is not there.
void removeImages(PosedModel& model, const std::vector<std::string>& names);

/// Median distance between observations and projections of the tracks' points, px; 0 without tracks.
double reprojectionError(const PosedModel& model);

/// Positions of the tracks that an image observes.
std::vector<glm::dvec3> pointsSeenBy(const PosedModel& model, std::uint32_t image);

/// The greater of the two in the middle where their number is even. Precondition: not empty. Reorders.
double median(std::vector<double>& values);

}  // namespace ibr
