// SPDX-License-Identifier: Apache-2.0
// Queries about a posed model and its cameras, and removal of its images.
#pragma once

#include <string>
#include <vector>

#include "base/median.h"
#include "ibr/author/poses.h"

namespace ibr {

/// Removes images, with their observations and the tracks that no other image observes. Throws Error{invalidInput} for
/// a name that the model lacks.
void removeImages(PosedModel& model, const std::vector<std::string>& names);

/// Median reprojection error of the tracks' points, px; 0 without tracks.
double reprojectionError(const PosedModel& model);

/// Max median reprojection error at which a model's poses count as exact, px.
inline constexpr double kExactPx = 0.1;

/// For each image the tracks that it observes, ascending and without duplicates.
std::vector<std::vector<std::uint32_t>> tracksOfImages(const PosedModel& model);

/// Max pixels of a matched image.
inline constexpr double kMatchPixels = 2e6;

/// The camera at its photograph's matched size. Limits of matching in px refer to this size.
Camera matchedCamera(Camera camera);

}  // namespace ibr
