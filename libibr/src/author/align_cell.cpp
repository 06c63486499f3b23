// SPDX-License-Identifier: Apache-2.0
#include "author/align_cell.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "author/alignment_grid.h"
#include "author/label.h"
#include "author/mean_frame.h"
#include "author/mesh_signs.h"
#include "author/photographs.h"
#include "author/posed_model.h"
#include "author/range_again.h"
#include "author/uncertainty.h"

namespace ibr {
namespace aligning {
namespace {
constexpr double kMostResidualPx = 3;  // of stored photographs
}

bool allowed(const Range& before, const Range& after, double pixelsPerStored) {
  if (before.inverseDistance > 0 && !(after.inverseDistance > 0)) return false;  // rays part
  return after.residualPx <= std::max(kMostResidualPx * pixelsPerStored, before.residualPx);
}

std::size_t takeBackFolded(const MorphMesh& mesh, Match& moved, const Signs& signs) {
  std::vector<bool> back(mesh.pointCount(), false);
  for (bool again = true; again;) {
    again = false;
    for (const glm::uvec3& t : mesh.triangles) {
      const auto folds = [&](const glm::uvec3& way) { return (signs(mesh.match, way) & ~signs(moved, way)) != 0; };
      if (!folds(t) && !folds(turned(t))) continue;
      for (int k = 0; k < 3; ++k) {
        const unsigned p = t[k];
        for (std::size_t i = 0; i < moved.size(); ++i) {
          if (moved[i][p] == mesh.match[i][p]) continue;
          moved[i][p] = mesh.match[i][p];
          back[p] = again = true;
        }
      }
    }
  }
  return std::size_t(std::ranges::count(back, true));
}

std::vector<bool> movedPoints(const Match& before, const Match& after) {
  std::vector<bool> moved(before[0].size(), false);
  for (std::size_t i = 0; i < before.size(); ++i)
    for (std::size_t p = 0; p < moved.size(); ++p)
      if (before[i][p] != after[i][p]) moved[p] = true;
  return moved;
}

std::vector<std::size_t> movedTriangles(const MorphMesh& mesh, const std::vector<bool>& moved) {
  std::vector<std::size_t> triangles;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::uvec3& corner = mesh.triangles[t];
    if (moved[corner.x] || moved[corner.y] || moved[corner.z]) triangles.push_back(t);
  }
  return triangles;
}

void takeRanges(MorphMesh& mesh, const std::vector<bool>& moved, std::span<const Range> range,
                std::span<const double> level) {
  for (std::size_t p = 0; p < moved.size(); ++p) {
    if (!moved[p]) continue;
    mesh.inverseDistance[p] = float(range[p].inverseDistance);
    for (std::size_t i = 0; i < mesh.ratio.size(); ++i) mesh.ratio[i][p] = float(range[p].ratio[i]);
  }
  MorphMesh fresh = mesh;
  for (std::size_t p = 0; p < moved.size(); ++p) fresh.uncertainty[p] = float(range[p].uncertainty);
  if (!level.empty()) widenUncertainty(fresh, level);
  for (std::size_t p = 0; p < moved.size(); ++p)
    if (moved[p]) mesh.uncertainty[p] = fresh.uncertainty[p];
}

CellQuality qualityOf(const MorphMesh& mesh, CellQuality quality, std::span<const Range> range,
                      const std::function<double(const glm::uvec3&)>& area) {
  double covered = 0, weighted = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.tier[t] != kTierAgrees) continue;
    const double size = area(mesh.triangles[t]);
    covered += size;
    weighted += size * double(mesh.ecc[t]);
  }
  const double before = quality.ecc;
  if (covered > 0) quality.ecc = std::clamp(weighted / covered, -1.0, 1.0);
  if (before > 0) quality.score = std::min(quality.score * std::max(quality.ecc, 0.0) / before, 1.0);
  std::vector<double> residuals;
  for (const Range& r : range) residuals.push_back(r.residualPx);
  if (!residuals.empty()) quality.residualPx = median(residuals);
  return quality;
}

}  // namespace aligning

namespace {

// The members at the size at which they were matched: there ρ is found and triangles are labelled.
class Matched {
 public:
  explicit Matched(std::span<const MatchView> views) : views_(views) {
    for (const MatchView& view : views) {
      cameras_.push_back(matchedCamera(view.camera));
      const Intrinsics &now = cameras_.back().intrinsics, &stored = view.camera.intrinsics;
      scale_.emplace_back(double(now.width) / stored.width, double(now.height) / stored.height);
    }
  }
  const std::vector<Camera>& cameras() const { return cameras_; }
  double pixelsPerStored() const { return scale_[0].x; }
  glm::dvec2 pixel(std::size_t member, glm::dvec2 stored) const { return stored * scale_[member]; }

  std::vector<std::vector<glm::dvec2>> match(const MorphMesh& mesh) const {
    std::vector<std::vector<glm::dvec2>> match(mesh.memberCount());
    for (std::size_t i = 0; i < match.size(); ++i)
      for (const glm::vec2 at : mesh.match[i]) match[i].push_back(pixel(i, at));
    return match;
  }

  std::vector<float> labels(const MorphMesh& mesh, std::span<const glm::uvec3> triangles) const {
    std::vector<Image8> small;
    small.reserve(views_.size());
    std::vector<const Image8*> pictures;
    aligning::Match member = mesh.match;
    for (std::size_t i = 0; i < views_.size(); ++i) {
      const Intrinsics& k = cameras_[i].intrinsics;
      const Image8& whole = views_[i].picture;
      const bool asIs = k.width == whole.width && k.height == whole.height;
      pictures.push_back(asIs ? &whole : &small.emplace_back(shrunk(whole, k.width, k.height)));
      for (glm::vec2& at : member[i]) at = glm::vec2(pixel(i, at));
    }
    return worstPairEcc(pictures, member, triangles);
  }

 private:
  std::span<const MatchView> views_;
  std::vector<Camera> cameras_;
  std::vector<glm::dvec2> scale_;
};

double meanArea(const MorphMesh& mesh, const glm::uvec3& t) {
  glm::dvec2 at[3] = {};
  for (const auto& match : mesh.match)
    for (int k = 0; k < 3; ++k) at[k] += glm::dvec2(match[t[k]]) / double(mesh.memberCount());
  const glm::dvec2 ab = at[1] - at[0], ac = at[2] - at[0];
  return std::max(0.5 * (ab.x * ac.y - ab.y * ac.x), 0.0);
}

}  // namespace

AlignedCell alignPinholes(const CellToAlign& input, const AlignmentOptions& options, const Aligner& aligner,
                          const ProgressCallback& progress) {
  const MorphMesh& before = input.cell.mesh;
  AlignedCell result{before, input.cell.quality, {}};
  const std::size_t n = before.pointCount();
  std::vector<glm::ivec2> size;
  for (const MatchView& view : input.views) size.emplace_back(view.picture.width, view.picture.height);
  AlignmentGrid grid = ontoGrid(before, size);
  Alignment& alignment = grid.alignment;
  for (const MatchView& view : input.views) alignment.pictures.push_back(&view.picture);
  result.facts.points = n;
  result.facts.judged = alignment.triangles.size();
  result.facts.fixed = grid.fixed;
  if (alignment.triangles.empty()) {
    AlignmentSummary& none = result.facts.summary;
    none.initialEcc = none.finalEcc = none.initialEccPaper = none.finalEccPaper = std::nan("");
    none.starEccBefore.assign(n, std::nanf(""));
    none.starEccAfter = none.starEccBefore;
    return result;
  }

  const Matched matched(input.views);
  const RangeSolver solver(meanFrame(matched.cameras()), matched.cameras(), before, matched.match(before), true);
  AlignmentOptions guarded = options;
  guarded.guard = [&](std::uint32_t point, std::span<const glm::ivec2> position) {
    std::vector<glm::dvec2> pixels;
    for (std::size_t i = 0; i < position.size(); ++i)
      pixels.push_back(matched.pixel(i, glm::dvec2(position[i]) / double(kAlignmentUnitsPerPixel)));
    return aligning::allowed(solver.before(point), solver.solve(point, pixels), matched.pixelsPerStored());
  };
  const auto start = alignment.position;
  result.facts.summary = aligner(alignment, guarded, progress);

  MorphMesh& mesh = result.mesh;
  mesh.match = movedMatch(before, start, alignment.position);
  result.facts.takenBack = aligning::takeBackFolded(before, mesh.match, meshSigns);
  const std::vector<bool> moved = aligning::movedPoints(before.match, mesh.match);
  result.facts.moved = std::size_t(std::ranges::count(moved, true));
  if (result.facts.moved == 0) return result;

  std::vector<Range> range;
  std::vector<double> level;
  const auto match = matched.match(mesh);
  for (std::size_t p = 0; p < n; ++p) {
    std::vector<glm::dvec2> pixels;
    for (const auto& list : match) pixels.push_back(list[p]);
    range.push_back(moved[p] ? solver.solve(p, pixels) : solver.before(p));
    level.push_back(solver.level() * range[p].perInverseDepth);
  }
  aligning::takeRanges(mesh, moved, range, level);
  const std::vector<std::size_t> changed = aligning::movedTriangles(mesh, moved);
  std::vector<glm::uvec3> corners;
  for (const std::size_t t : changed) corners.push_back(mesh.triangles[t]);
  const std::vector<float> ecc = matched.labels(mesh, corners);
  for (std::size_t t = 0; t < changed.size(); ++t) mesh.ecc[changed[t]] = ecc[t];
  result.quality =
      aligning::qualityOf(mesh, input.cell.quality, range, [&](const glm::uvec3& t) { return meanArea(mesh, t); });
  return result;
}

}  // namespace ibr
