// SPDX-License-Identifier: Apache-2.0
// Matches vertices between all pairs of cameras that see them ([H] Alg. 3): where image i shows what image j shows.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "author/htm/htm_refine.h"
#include "author/htm/htm_segment.h"
#include "author/htm/htm_views.h"
#include "ibr/log.h"
#include "ibr/template_search.h"

namespace ibr {

/// Maximum number of template samples that a thread holds: 64 MiB.
inline constexpr std::size_t kTemplatePortion = (std::size_t(64) << 20) / sizeof(TemplateSample);

struct VertexMatchOptions {
  TemplateMeasure measure = TemplateMeasure::absoluteDifferences;
  double radius = 16;     // px around the start that are searched in each coordinate
  double minTexture = 2;  // 8-bit levels per px: directions in which a segment's colours change less are not measured
  SegmentOptions segment;
  int threads = 0;
  std::size_t portion = kTemplatePortion;  // samples searched in one call, at least one template; results do not depend
                                           // on the value
};

/// One at each complementIndex. `projected`: projectedMeshes of the mesh and the views at full size. `members`: the
/// cameras that see each vertex. `start`: complements to search around, or empty. `progress` reports cameras. Throws
/// Error{cancelled} and what the search throws.
std::vector<VertexMatch> matchVertices(const TriangleMesh& mesh, std::span<const HtmView> views,
                                       std::span<const ProjectedMesh> projected, std::span<const CameraSet> members,
                                       std::span<const glm::vec2> start, const VertexMatchOptions& options,
                                       const TemplateSearchFactory& makeSearch, const ProgressCallback& progress);

}  // namespace ibr
