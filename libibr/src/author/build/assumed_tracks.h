// SPDX-License-Identifier: Apache-2.0
// Assumed points for photographs without tracks (often panoramas), whose distances are still unknown.
#pragma once

#include <vector>

#include "ibr/author/poses.h"
#include "ibr/camera.h"

namespace ibr {

/// Creates points for each photograph with `hasNone`, each observed by this photograph alone: a grid of directions over
/// its image, at 1, 2, 5 and 20 times the median distance between neighbouring capture sites.
std::vector<Track> assumedTracks(const std::vector<Camera>& photographs, const std::vector<bool>& hasNone);

}  // namespace ibr
