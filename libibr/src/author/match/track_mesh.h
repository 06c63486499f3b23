// SPDX-License-Identifier: Apache-2.0
// Delaunay mesh of matches: rejects matches that their neighbours contradict, and interpolates between matches.
#pragma once

#include <glm/gtc/type_precision.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "author/sweep/plane_maps.h"
#include "ibr/image.h"

namespace ibr {

/// Triangulates the tracks' positions in the first member.
std::vector<glm::uvec3> trackTriangles(std::span<const PlaneTrack> tracks);

/// Returns for each track those that share a triangle with it, ascending.
std::vector<std::vector<std::uint32_t>> trackNeighbours(std::size_t count, std::span<const glm::uvec3> triangles);

/// Drops tracks that are farther than `px` from the planes of all their neighbours, or whose neighbours have no plane.
/// Then drops tracks whose triangles fold over.
void dropContradicted(std::vector<PlaneTrack>& tracks, std::span<const PlaneMaps> planes, double px);

/// Drops one track of each triangle that folds over in one of the first `members` members, and triangulates again,
/// until none folds, at most 30 times.
void dropFolded(std::vector<PlaneTrack>& tracks, std::size_t members);

/// Returns the planes within `px` of each track: at most the four nearest, ascending and counted from 1, padded with 0.
/// The plane of the track itself always counts as the nearest.
std::vector<glm::u16vec4> planeLabels(std::span<const PlaneTrack> tracks, std::span<const PlaneMaps> planes, double px);

/// Maps each pixel of the first member to its position in each member: by the plane that a triangle's corners share,
/// else by linear interpolation. `known`: 1 channel, 1 inside triangles.
struct TrackField {
  std::vector<ImageF> position;
  Image8 known;
};
TrackField fieldOf(std::span<const PlaneTrack> tracks, std::span<const glm::uvec3> triangles,
                   std::span<const glm::u16vec4> labels, std::span<const PlaneMaps> planes, std::size_t members,
                   glm::ivec2 size);

}  // namespace ibr
