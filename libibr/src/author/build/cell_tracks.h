// SPDX-License-Identifier: Apache-2.0
// Tracks for photographs whose model has none, as panoramas' often has: vertices of the cells' meshes.
#pragma once

#include <cstddef>
#include <vector>

#include "ibr/author.h"
#include "ibr/scene.h"

namespace ibr {

inline constexpr std::size_t kTracksOfCell = 300;  // about

/// Vertices of tier 0, spread over each cell that has a photograph for which `hasNone` is true; each observed by all of
/// the cell's members. Images are the scene's nodes, by index.
std::vector<Track> cellTracks(const Scene& scene, const std::vector<bool>& hasNone);

}  // namespace ibr
