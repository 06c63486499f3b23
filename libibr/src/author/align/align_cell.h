// SPDX-License-Identifier: Apache-2.0
// One cell through the optimiser (ibr/optimise_scene.h): onto the grid, aligned, back, and all that follows from where
// its points stand.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "author/align/alignment_grid.h"
#include "author/align/range_again.h"
#include "author/match/match.h"
#include "ibr/optimise_scene.h"

namespace ibr {

/// What is optimised: pictures and cameras at the stored size. Both outlive the call.
struct CellToAlign {
  std::span<const MatchView> views;
  const Cell& cell;
};

struct AlignedCell {
  MorphMesh mesh;
  CellQuality quality;
  OptimisedCell facts;  // without number, members and time
};

/// Of a cell whose members are pinholes, or all are panoramas.
AlignedCell alignCell(const CellToAlign& input, const AlignmentOptions& options, const Aligner& aligner,
                      const ProgressCallback& progress);

/// Panoramas are optimised on the faces of a cube (panorama_faces.h) in which all members look the same way: a point in
/// the face that it lies in, if its whole star is well inside that face for all members, and then no other. No edge is
/// flipped and no point inserted, though it is asked for.
AlignedCell alignPanoramas(const CellToAlign& input, const AlignmentOptions& options, const Aligner& aligner,
                           const ProgressCallback& progress);

AlignedCell alignPinholes(const CellToAlign& input, const AlignmentOptions& options, const Aligner& aligner,
                          const ProgressCallback& progress);

/// Parts that pinholes and faces of panoramas share.
namespace aligning {

using Match = std::vector<std::vector<glm::vec2>>;  // d × n, px
using Signs = std::function<std::uint32_t(const Match&, const glm::uvec3&)>;

/// The members at the size at which they were matched: there ρ is found and triangles are labelled.
class MatchedSize {
 public:
  explicit MatchedSize(std::span<const MatchView> views);
  const std::vector<Camera>& cameras() const { return cameras_; }
  double pixelsPerStored() const { return scale_[0].x; }
  glm::dvec2 pixel(std::size_t member, glm::dvec2 stored) const { return stored * scale_[member]; }
  std::vector<std::vector<glm::dvec2>> match(const Match& stored) const;

  /// MorphMesh::ecc of triangles, of matches in px of the views.
  std::vector<float> labels(const Match& stored, std::span<const glm::uvec3> triangles) const;

 private:
  std::span<const MatchView> views_;
  std::vector<Camera> cameras_;
  std::vector<glm::dvec2> scale_;
};

/// A mesh over pinhole pictures, aligned.
class PictureAlignment {
 public:
  /// All outlive the object. `fixed`: n, or none. `widened`: as RangeSolver has it; `frame`: at the matched size.
  PictureAlignment(std::span<const MatchView> views, const MorphMesh& mesh, const Camera& frame, bool widened,
                   const std::vector<std::uint8_t>& fixed = {});

  /// Where its points stand then, inserted ones last; those that did not move to the bit as they stood.
  /// `options.flipEdges`, `options.insertPoints`: triangles().
  Match run(const AlignmentOptions& options, const Aligner& aligner, const ProgressCallback& progress);

  /// The mesh's, with the edges that run() has flipped and points that it has inserted: an index has one of the same
  /// tier, that turns the same way. There may be more, of tier 0.
  std::vector<glm::uvec3> triangles() const;
  const std::vector<InsertedPoint>& inserted() const { return grid_.alignment.inserted; }

  const AlignmentSummary& summary() const { return summary_; }
  std::size_t judged() const { return grid_.alignment.triangles.size(); }
  std::size_t fixed() const { return grid_.fixed; }
  RangeFit range(std::size_t point, const Match& match) const;
  /// Of a point that was inserted: its inverse depth should be that between its parents, or near one of theirs.
  /// `range`: of all points before it.
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

/// No triangle is judged: ECCs are NaN.
AlignmentSummary nothingJudged(std::size_t points);

/// Moves back, in all pictures, what turns a triangle of the mesh over that was not. Gives the number of points.
std::size_t takeBackFolded(const MorphMesh& mesh, Match& moved, const Signs& signs);

/// Moves points back as above, but with the triangles of `now`, which has those of `before` with edges flipped, and
/// more points and triangles at the ends. Where a new one would then be folded over in a picture or a mean, first all
/// edges are flipped back and all inserted points taken out. Of `now`, matches and triangles are used.
std::size_t takeBackFolded(const MorphMesh& before, MorphMesh& now);

/// Whether a point stands elsewhere in any picture, or was not there.
std::vector<bool> movedPoints(const Match& before, const Match& after);

/// Triangles with a corner that moved, by number.
std::vector<std::size_t> movedTriangles(const MorphMesh& mesh, const std::vector<bool>& moved);

/// Triangles whose corners are not those of `before`, or that were not there, by number.
std::vector<std::size_t> changedTriangles(const MorphMesh& before, const MorphMesh& now);

/// ρ, a_i and uncertainty of what moved. `range`: n, used for points that moved; `level`: n, as widenUncertainty has
/// it, or none where uncertainties are not widened.
void takeRanges(MorphMesh& mesh, const std::vector<bool>& moved, std::span<const RangeFit> range,
                std::span<const double> level);

/// Room for the points and triangles that the mesh has more than its lists of what it knows of them: triangles are of
/// tier 0, points on the planes that all their parents lie on.
void growLists(MorphMesh& mesh, std::span<const InsertedPoint> inserted);

/// Brings triangles of tier 0 before all others; otherwise their order stays.
void sortByTier(MorphMesh& mesh);

/// ECC, residual and score of the mesh as it is now. `residuals`: of its points. `area`: of each triangle, in any unit.
CellQuality qualityOf(const MorphMesh& mesh, CellQuality quality, std::vector<double> residuals,
                      const std::function<double(const glm::uvec3&)>& area);

}  // namespace aligning
}  // namespace ibr
