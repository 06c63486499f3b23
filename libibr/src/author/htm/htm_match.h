// SPDX-License-Identifier: Apache-2.0
// [H] Alg. 3: where in picture i lies what picture j shows at a vertex, for all pairs of cameras that see it.
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

/// Samples of templates that a thread holds at once: 64 MiB of them.
inline constexpr std::size_t kTemplatePortion = (std::size_t(64) << 20) / sizeof(TemplateSample);

struct VertexMatchOptions {
  TemplateMeasure measure = TemplateMeasure::absoluteDifferences;
  double radius = 16;       // px that are searched around the start in each coordinate
  double leastTexture = 2;  // levels per px: a direction in which a segment's colours change less says nothing
  SegmentOptions segment;
  int threads = 0;
  std::size_t portion = kTemplatePortion;  // samples that are searched in one call, or one template; no result depends
                                           // on it
};

/// One at each complementIndex. `projected`: projectedMeshes of the mesh and the views at full size. `members`: the
/// cameras that see each vertex. `start`: complements to search around, or empty. `progress` reports cameras. Throws
/// Error{cancelled} and what the search throws.
std::vector<VertexMatch> matchVertices(const TriangleMesh& mesh, std::span<const HtmView> views,
                                       std::span<const ProjectedMesh> projected, std::span<const CameraSet> members,
                                       std::span<const glm::vec2> start, const VertexMatchOptions& options,
                                       const MakeTemplateSearch& makeSearch, const ProgressCallback& progress);

}  // namespace ibr
