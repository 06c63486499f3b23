// SPDX-License-Identifier: Apache-2.0
// Runs the optimiser (ibr/author/optimise_scene.h) on one cell: puts the mesh onto the grid, aligns the mesh, converts
// the result back, and recomputes ranges, labels and quality of the moved points.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "author/align/alignment_grid.h"
#include "author/align/range_solver.h"
#include "author/match/match.h"
#include "ibr/author/optimise_scene.h"

namespace ibr {

/// Input of the optimiser: images and cameras at the stored size. Both must outlive the call.
struct CellAlignmentInput {
  std::span<const MatchView> views;
  const Cell& cell;
};

struct AlignedCell {
  MorphMesh mesh;
  CellQuality quality;
  OptimisedCell facts;  // without cell, members and seconds
};

/// Aligns a cell whose members are all pinholes or all panoramas.
AlignedCell alignCell(const CellAlignmentInput& input, const AlignmentOptions& options, const Aligner& aligner,
                      const ProgressCallback& progress);

/// Aligns a cell of panoramas on the faces of a cube (panorama_faces.h) that has the same orientation for all members.
/// A point moves only in the face that contains the point, and only if all its triangles lie well inside that face in
/// all members. Ignores options.flipEdges and options.insertPoints.
AlignedCell alignPanoramas(const CellAlignmentInput& input, const AlignmentOptions& options, const Aligner& aligner,
                           const ProgressCallback& progress);

AlignedCell alignPinholes(const CellAlignmentInput& input, const AlignmentOptions& options, const Aligner& aligner,
                          const ProgressCallback& progress);

/// Parts that alignPinholes and alignPanoramas share.
namespace aligning {

using Match = std::vector<std::vector<glm::vec2>>;  // d × n, px
using Signs = std::function<std::uint32_t(const Match&, const glm::uvec3&)>;

/// The members at the matched size, at which ρ is solved and triangles are labelled.
class MatchedSize {
 public:
  explicit MatchedSize(std::span<const MatchView> views);
  const std::vector<Camera>& cameras() const { return cameras_; }
  double pixelsPerStored() const { return scale_[0].x; }
  glm::dvec2 pixel(std::size_t member, glm::dvec2 stored) const { return stored * scale_[member]; }
  std::vector<std::vector<glm::dvec2>> match(const Match& stored) const;

  /// Returns MorphMesh::ecc of triangles. The matches are in px of the views.
  std::vector<float> labels(const Match& stored, std::span<const glm::uvec3> triangles) const;

 private:
  std::span<const MatchView> views_;
  std::vector<Camera> cameras_;
  std::vector<glm::dvec2> scale_;
};

/// Aligns a mesh over pinhole images.
class PictureAlignment {
 public:
  /// Arguments must outlive the object. `fixed`: n flags or empty. `widened`: see RangeSolver. `frame`: matched size.
  PictureAlignment(std::span<const MatchView> views, const MorphMesh& mesh, const Camera& frame, bool widened,
                   const std::vector<std::uint8_t>& fixed = {});

  /// Returns the points' final positions, inserted points last. A point that did not move keeps its position to the
  /// bit. With `options.flipEdges` or `options.insertPoints`, use alignedTriangles() afterwards.
  Match run(const AlignmentOptions& options, const Aligner& aligner, const ProgressCallback& progress);

  /// The mesh's triangles with the flips and insertions of run(). Each index keeps its tier and its orientation;
  /// a triangle that was divided keeps its index for one part. The other parts follow at the end, all of tier 0.
  std::vector<glm::uvec3> alignedTriangles() const;
  const std::vector<InsertedPoint>& inserted() const { return grid_.alignment.inserted; }

  const AlignmentSummary& summary() const { return summary_; }
  std::size_t judged() const { return grid_.alignment.triangles.size(); }
  std::size_t fixed() const { return grid_.fixed; }
  RangeFit range(std::size_t point, const Match& match) const;
  /// Range of an inserted point. Its prior is the inverse depth interpolated between its parents; the spread of the
  /// parents widens the prior. `range`: of all points before this one.
  RangeFit range(std::size_t point, const Match& match, std::span<const RangeFit> range,
                 const InsertedPoint& from) const;
  const RangeFit& before(std::size_t point) const { return ranges_.before(point); }
  double level() const { return ranges_.level(); }

 private:
  bool allows(std::uint32_t point, std::span<const glm::ivec2> position) const;
  std::vector<glm::dvec2> pixelsOf(std::size_t point, const Match& match) const;

  std::span<const MatchView> views_;
  const MorphMesh& mesh_;
  MatchedSize matched_;
  AlignmentGrid grid_;
  RangeSolver ranges_;
  AlignmentSummary summary_;
};

/// Summary of an alignment without judged triangles: all ECCs are NaN.
AlignmentSummary emptySummary(std::size_t points);

/// Moves points back, in all images, where a triangle is folded over that was not before. Returns the number of points.
std::size_t revertFolded(const MorphMesh& mesh, Match& moved, const Signs& signs);

/// Moves points back as above, for a mesh `now` that has flipped edges and inserted points at the ends of its lists. If
/// a new triangle would then be folded over in an image or a mean, all flips and insertions are undone first. Uses only
/// matches and triangles of `now`.
std::size_t revertFolded(const MorphMesh& before, MorphMesh& now);

/// Flags of the points that moved in any image or were inserted.
std::vector<bool> movedPoints(const Match& before, const Match& after);

/// Indices of the triangles with a moved corner.
std::vector<std::size_t> movedTriangles(const MorphMesh& mesh, const std::vector<bool>& moved);

/// Indices of the triangles that are new or have other corners than in `before`.
std::vector<std::size_t> changedTriangles(const MorphMesh& before, const MorphMesh& now);

/// Sets ρ, a_i and uncertainty of moved points. `range`: n entries, used for moved points. `level`: n entries, as for
/// widenUncertainty; empty where uncertainties are not widened.
void updateRanges(MorphMesh& mesh, const std::vector<bool>& moved, std::span<const RangeFit> range,
                  std::span<const double> level);

/// Extends the per-point and per-triangle lists to the mesh's new points and triangles. New triangles get tier 0. New
/// points get the planes that all their parents share.
void extendLists(MorphMesh& mesh, std::span<const InsertedPoint> inserted);

/// Moves triangles of tier 0 before all others, and otherwise keeps their order.
void sortByTier(MorphMesh& mesh);

/// Quality with ECC, residual and score of the mesh. `residuals`: of its points. `area`: of a triangle, in any unit.
CellQuality qualityOf(const MorphMesh& mesh, CellQuality quality, std::vector<double> residuals,
                      const std::function<double(const glm::uvec3&)>& area);

}  // namespace aligning
}  // namespace ibr
