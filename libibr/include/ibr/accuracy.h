// SPDX-License-Identifier: Apache-2.0
// How right the matches and labels of a scene's cells are, where exact depth of the place is known, and what exact
// matches would be. Needs ibr::author.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "ibr/camera.h"
#include "ibr/image.h"
#include "ibr/log.h"
#include "ibr/scene.h"

namespace ibr {

/// Exact depth of a view: 1 channel, world units along its axis at pixel centres, 0 = infinitely far. A pinhole.
struct DepthView {
  Camera camera;
  ImageF depth;
};

/// Pixels are those of the members' stored photographs. What the depth views have not seen is not counted anywhere. A
/// surface is right in a triangle where the triangle's matches are within 1.5 px of it in every member and every member
/// sees it; a triangle is right where 80 % of its known pixels in the first member are.
struct MatchAccuracy {
  std::vector<double> vertexError;  // px, each vertex of tier 0: the worst member's distance from the exact match
  std::vector<double> deviation;    // of the same vertices: error of ρ over its uncertainty, without sign
  double coVisible = 0;             // px of the first member whose surface all members see
  double kept = 0;                  // … of them, under triangles of tier 0
  double tier0 = 0;                 // px under triangles of tier 0
  double rightTier0 = 0;            // … of those that are right
  double right = 0;                 // px under right triangles of tier 0 or 1
  std::size_t folded = 0;           // triangles of tier 0 that turn over from member to member

  MatchAccuracy& operator+=(const MatchAccuracy& other);
};

/// One for each cell of the scene. Cells with a panorama get zeros. Throws Error{invalidInput} where a view is no
/// pinhole or its depth has another size, Error{cancelled} where `progress` says so. 0 threads: all cores.
std::vector<MatchAccuracy> matchAccuracy(const Scene& scene, std::span<const DepthView> truth, int threads = 0,
                                         const ProgressCallback& progress = {});

struct ExactMatchOptions {
  double withinPx = 4;     // points of tier 0 whose worst match is further off stay: they are on another surface
  double noisePx = 0;      // afterwards each coordinate, but in the first member, is off by up to so much, evenly
  std::uint64_t seed = 1;  // of the noise; same scene, truth and options: same result
};

/// Puts points of tier 0 where the surface that the first member sees there is in all members, with its ρ and a_i: a
/// scene that shows what is lost because matches are wrong. With noise, ρ, a_i and uncertainty are triangulated from
/// the disturbed matches alone: a scene that shows what an optimiser of matches wins back. The settings tell of both. A
/// point stays as it is where a triangle would turn over in a member or in a mean of members, or a member's picture
/// would be left; so do all other points, triangles and labels. Gives the number of points that moved. Throws as
/// matchAccuracy(), and Error{invalidInput} where an option is out of range (withinPx > 0, noisePx 0 to 64); then the
/// scene is as it was.
std::size_t setExactMatches(Scene& scene, std::span<const DepthView> truth, const ExactMatchOptions& options,
                            int threads = 0, const ProgressCallback& progress = {});

}  // namespace ibr
