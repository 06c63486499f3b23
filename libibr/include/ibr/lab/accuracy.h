// SPDX-License-Identifier: Apache-2.0
// Accuracy of the matches and tiers of a scene's cells, measured with exact depth; replacement of matches by exact
// ones. Needs ibr::author.
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

/// Exact depth of a view.
struct ExactDepthView {
  Camera camera;  // a pinhole
  ImageF depth;   // 1 channel: world units along the viewing axis, at pixel centres; 0: infinitely far
};

/// Accuracy of a cell. Pixels are those of the members' stored photographs. Surfaces that no depth view sees are
/// unknown and never counted. A pixel of the first member is correct if every member sees its surface at most 1.5 px
/// from where the triangle's matches place the pixel. A triangle is correct if 80 % of its known pixels are correct.
struct MatchAccuracy {
  std::vector<double> vertexErrorsPx;  // px, of vertices of tier 0: distance from the exact match, in the worst member
  std::vector<double> deviation;       // of the same vertices: absolute error of ρ over its uncertainty
  double coVisible = 0;                // pixels of the first member whose surface all members see
  double coVisibleTier0 = 0;           // pixels of coVisible under triangles of tier 0
  double tier0 = 0;                    // pixels under triangles of tier 0
  double correctTier0 = 0;             // pixels under correct triangles of tier 0
  double correct = 0;                  // pixels under correct triangles of tier 0 or 1
  std::size_t folded = 0;              // triangles of tier 0 that turn over between members

  MatchAccuracy& operator+=(const MatchAccuracy& other);
};

/// Returns the accuracy of each cell of the scene; zeros for cells with a panorama. 0 threads: all cores. Throws
/// Error{invalidInput} for a view that is no pinhole or whose depth has another size, Error{cancelled} by `progress`.
std::vector<MatchAccuracy> matchAccuracy(const Scene& scene, std::span<const ExactDepthView> truth, int threads = 0,
                                         const ProgressCallback& progress = {});

struct ExactMatchOptions {
  double maxErrorPx = 4;   // points of tier 0 stay if their worst match is farther off: they are on another surface
  double noisePx = 0;      // amplitude of the uniform noise added to coordinates in all members but the first
  std::uint64_t seed = 1;  // of the noise; same scene, truth and options: same result
};

/// Moves points of tier 0, in all members, to the surface that the first member sees there, with the surface's ρ and
/// a_i. Such a scene shows the loss caused by inaccurate matches. With noise, ρ, a_i and uncertainty are triangulated
/// from the noisy matches alone. Such a scene shows how much of the loss an optimiser can regain. Scene::settings
/// records the options. A point stays if it would leave a member's image. A point also stays if a triangle would turn
/// over in a member or in a mean of members. Other points, triangles and tiers stay too; MorphMesh::confirmations and
/// consensus of changed cells are cleared. Returns the number of moved points. Throws as matchAccuracy(), and
/// Error{invalidInput} for an option out of range (maxErrorPx > 0, noisePx 0 to 64); then the scene is unchanged.
std::size_t setExactMatches(Scene& scene, std::span<const ExactDepthView> truth, const ExactMatchOptions& options,
                            int threads = 0, const ProgressCallback& progress = {});

}  // namespace ibr
