// SPDX-License-Identifier: Apache-2.0
// Points for photographs whose model has none, as panoramas' often has: nobody knows yet how far away anything is.
#pragma once

#include <vector>

#include "ibr/author.h"
#include "ibr/camera.h"

namespace ibr {

/// Points that each photograph for which `hasNone` is true observes alone: a grid of directions over its picture, at
/// 1, 2, 5 and 20 times the median distance between neighbouring capture sites.
std::vector<Track> assumedTracks(const std::vector<Camera>& photographs, const std::vector<bool>& hasNone);

}  // namespace ibr
