// SPDX-License-Identifier: Apache-2.0
#include "author/align/align_cell.h"

#include <algorithm>
#include <glm/common.hpp>
#include <iterator>

#include "author/align/aligned_mesh.h"
#include "author/align/picture_alignment.h"
#include "author/geometry/mean_frame.h"
#include "author/photographs/masks.h"

namespace ibr {
namespace {

// Points of triangles that may contain masked pixels, which would distort the match. Empty if nothing is masked.
std::vector<std::uint8_t> nearMasks(std::span<const MatchView> views, const MorphMesh& mesh) {
  std::vector<std::uint8_t> beside;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const Image8& mask = views[i].mask;
    if (ignoredShare(mask) == 0) continue;
    beside.resize(mesh.vertexCount(), 0);
    for (const glm::uvec3& t : mesh.triangles) {
      const glm::vec2 a = mesh.match[i][t.x], b = mesh.match[i][t.y], c = mesh.match[i][t.z];
      const glm::ivec2 last(mask.width - 1, mask.height - 1);
      const glm::ivec2 low = glm::clamp(glm::ivec2(glm::min(glm::min(a, b), c)), glm::ivec2(0), last);
      const glm::ivec2 high = glm::clamp(glm::ivec2(glm::max(glm::max(a, b), c)), glm::ivec2(0), last);
      bool masked = false;
      for (int y = low.y; y <= high.y && !masked; ++y)
        for (int x = low.x; x <= high.x && !masked; ++x) masked = !mask.pixel(x, y)[0];
      if (masked) beside[t.x] = beside[t.y] = beside[t.z] = 1;
    }
  }
  return beside;
}

double meanArea(const MorphMesh& mesh, const glm::uvec3& t) {
  glm::dvec2 at[3] = {};
  for (const auto& match : mesh.match)
    for (int k = 0; k < 3; ++k) at[k] += glm::dvec2(match[t[k]]) / double(mesh.memberCount());
  const glm::dvec2 ab = at[1] - at[0], ac = at[2] - at[0];
  return std::max(0.5 * (ab.x * ac.y - ab.y * ac.x), 0.0);
}

// Figures of an alignment, without flipped triangles and without moved and reverted points.
OptimisedCell alignmentFigures(const aligning::PictureAlignment& alignment, const MorphMesh& before,
                               const MorphMesh& mesh) {
  OptimisedCell facts;
  facts.points = before.vertexCount();
  facts.evaluated = alignment.judged();
  facts.fixed = alignment.fixed();
  facts.summary = alignment.summary();
  facts.inserted = mesh.match[0].size() - facts.points;
  if (facts.inserted == 0 && facts.summary.insertions > 0) {  // undone, along with all flips
    facts.summary.insertions = facts.summary.flips = 0;
    facts.summary.initialStarEcc.resize(facts.points);
    facts.summary.finalStarEcc.resize(facts.points);
  }
  return facts;
}

// Sets ρ, a_i and uncertainty of moved and inserted points. Returns the residuals of all points, px.
std::vector<double> solveRanges(const aligning::PictureAlignment& alignment, const std::vector<bool>& moved,
                                std::span<const InsertedPoint> inserted, MorphMesh& mesh) {
  const std::size_t stored = mesh.vertexCount() - inserted.size();
  std::vector<RangeFit> range;
  std::vector<double> level, residuals;
  for (std::size_t p = 0; p < mesh.vertexCount(); ++p) {
    range.push_back(p >= stored ? alignment.range(p, mesh.match, range, inserted[p - stored])
                    : moved[p]  ? alignment.range(p, mesh.match)
                                : alignment.before(p));
    level.push_back(alignment.level() * range[p].perInverseDepth);
    residuals.push_back(range[p].residualPx);
  }
  aligning::updateRanges(mesh, moved, range, level);
  return residuals;
}

// Labels the triangles `changed` again.
void relabel(const aligning::MatchedSize& matched, const std::vector<std::size_t>& changed, MorphMesh& mesh) {
  std::vector<glm::uvec3> corners;
  for (const std::size_t t : changed) corners.push_back(mesh.triangles[t]);
  const std::vector<float> ecc = matched.labels(mesh.match, corners);
  for (std::size_t t = 0; t < changed.size(); ++t) mesh.ecc[changed[t]] = ecc[t];
}

}  // namespace

AlignedCell alignPinholes(const CellAlignmentInput& input, const AlignmentOptions& options, const Aligner& aligner,
                          const ProgressCallback& progress) {
  const MorphMesh& before = input.cell.mesh;
  AlignedCell result{before, input.cell.quality, {}};
  MorphMesh& mesh = result.mesh;
  const aligning::MatchedSize matched(input.views);
  aligning::PictureAlignment alignment(input.views, before, meanFrame(matched.cameras()), true,
                                       nearMasks(input.views, before));
  mesh.match = alignment.run(options, aligner, progress);
  mesh.triangles = alignment.alignedTriangles();
  const std::size_t reverted = aligning::revertFolded(before, mesh);
  OptimisedCell& facts = result.facts;
  facts = alignmentFigures(alignment, before, mesh);
  facts.reverted = reverted;
  const std::vector<std::size_t> joined = aligning::changedTriangles(before, mesh);
  facts.flipped = std::size_t(std::ranges::count_if(joined, [&](std::size_t t) {
    const glm::uvec3& corner = mesh.triangles[t];
    return std::max({corner.x, corner.y, corner.z}) < facts.points;
  }));
  const std::vector<bool> moved = aligning::movedPoints(before.match, mesh.match);
  facts.moved = std::size_t(std::ranges::count(moved, true)) - facts.inserted;
  if (facts.moved + joined.size() == 0) return result;

  const std::span inserted = std::span(alignment.inserted()).first(facts.inserted);
  aligning::extendLists(mesh, inserted);
  const std::vector<double> residuals = solveRanges(alignment, moved, inserted, mesh);
  std::vector<std::size_t> changed;
  std::ranges::set_union(aligning::movedTriangles(mesh, moved), joined, std::back_inserter(changed));
  relabel(matched, changed, mesh);
  aligning::sortByTier(mesh);
  result.quality =
      aligning::qualityOf(mesh, input.cell.quality, residuals, [&](const glm::uvec3& t) { return meanArea(mesh, t); });
  return result;
}

AlignedCell alignCell(const CellAlignmentInput& input, const AlignmentOptions& options, const Aligner& aligner,
                      const ProgressCallback& progress) {
  const bool panoramic = input.views[0].camera.intrinsics.model == CameraModel::equirectangular;
  for (const MatchView& view : input.views)
    if ((view.camera.intrinsics.model == CameraModel::equirectangular) != panoramic) {
      AlignedCell as{input.cell.mesh, input.cell.quality, {}};  // no build makes such a cell
      as.facts.points = input.cell.mesh.vertexCount();
      as.facts.summary = aligning::emptySummary(as.facts.points);
      return as;
    }
  return (panoramic ? alignPanoramas : alignPinholes)(input, options, aligner, progress);
}

}  // namespace ibr
