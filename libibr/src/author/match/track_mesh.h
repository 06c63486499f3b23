// SPDX-License-Identifier: Apache-2.0
// The Delaunay mesh of matches: which of them their neighbours contradict, and what lies between them.
#pragma once

#include <glm/gtc/type_precision.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "author/sweep/plane_maps.h"
#include "ibr/image.h"

namespace ibr {

/// Triangles on the tracks' places in the first member.
std::vector<glm::uvec3> trackTriangles(std::span<const PlaneTrack> tracks);

/// For each track those it shares a triangle with, ascending.
std::vector<std::vector<std::uint32_t>> trackNeighbours(std::size_t count, std::span<const glm::uvec3> triangles);

/// Drops tracks that no neighbour bears out: that lie on a plane of none of them, and farther than `px` from where the
/// nearest of their planes puts them; then those about which triangles turn over.
void dropContradicted(std::vector<PlaneTrack>& tracks, std::span<const PlaneMaps> planes, double px);

/// Drops tracks about which triangles turn over in one of the first `members` members.
void dropFolded(std::vector<PlaneTrack>& tracks, std::size_t members);

/// The planes that each track lies on to `px`: at most four, the nearest, in ascending order and counted from 1, filled
/// up with 0. The plane it was found on comes first in this choice.
std::vector<glm::u16vec4> planeLabels(std::span<const PlaneTrack> tracks, std::span<const PlaneMaps> planes, double px);

/// Where each pixel of the first member is seen in each member: by the plane that a triangle's corners share, else
/// linear between them. `known`: 1 channel, 1 inside triangles.
struct TrackField {
  std::vector<ImageF> position;
  Image8 known;
};
TrackField fieldOf(std::span<const PlaneTrack> tracks, std::span<const glm::uvec3> triangles,
                   std::span<const glm::u16vec4> labels, std::span<const PlaneMaps> planes, std::size_t members,
                   glm::ivec2 size);

}  // namespace ibr
