// SPDX-License-Identifier: Apache-2.0
// Estimates the pose of one photograph among others of fixed poses, from the points that they share.
#pragma once

#include <optional>
#include <string>

#include "ibr/author/poses.h"

namespace ibr {

/// Returns the camera of the photograph `name` of `given` that best fits its observations of the tracks of `given` that
/// `others` see, too. The others are fixed; photographs that share their intrinsics in `given` pass theirs on. nullopt
/// for panoramas, and for fewer than 20 shared points. Precondition: `given` contains the photograph.
std::optional<Camera> resected(const PosedModel& given, const std::string& name, const PosedModel& others);

}  // namespace ibr
