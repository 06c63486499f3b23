// SPDX-License-Identifier: Apache-2.0
// The pose of one photograph among others whose poses stay: by what it shows of the points that they share.
#pragma once

#include <optional>
#include <string>

#include "ibr/author.h"

namespace ibr {

/// The camera of the photograph `name` of `given` that suits best where it sees the tracks of `given`, which others of
/// `others` see, too; all these stay, and it has their intrinsics where it shared them in `given`. Px of its camera
/// there. nullopt for panoramas, and where it shares fewer than 20 points. Precondition: `given` has it.
std::optional<Camera> resected(const PosedModel& given, const std::string& name, const PosedModel& others);

}  // namespace ibr
