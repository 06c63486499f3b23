// SPDX-License-Identifier: Apache-2.0
// Alignment of one mesh over pinhole images: the conversion to the optimiser's grid and back, and the limits of
// triangulation that guard each move. Cells of pinholes have one mesh; cells of panoramas have one for each cube face.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "author/align/aligned_mesh.h"
#include "author/align/alignment_grid.h"
#include "author/align/range_solver.h"
#include "author/match/match.h"
#include "ibr/author/optimise_scene.h"

namespace ibr::aligning {

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
  /// `views` and `mesh` must outlive the object. `fixed`: n flags or empty. `widened`: see RangeSolver. `frame`:
  /// matched size.
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

}  // namespace ibr::aligning
