// SPDX-License-Identifier: Apache-2.0
#include "author/align/align_cell.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <iterator>
#include <limits>

#include "author/align/alignment_grid.h"
#include "author/align/range_solver.h"
#include "author/geometry/epipolar_direction.h"
#include "author/geometry/mean_frame.h"
#include "author/geometry/mesh_signs.h"
#include "author/geometry/posed_model.h"
#include "author/mesh/label.h"
#include "author/mesh/uncertainty.h"
#include "author/photographs/masks.h"
#include "ibr/author/photographs.h"

namespace ibr {
namespace aligning {
namespace {

constexpr double kMaxResidualPx = 3;  // px of stored photographs

std::vector<glm::ivec2> sizesOf(std::span<const MatchView> views) {
  std::vector<glm::ivec2> sizes;
  for (const MatchView& view : views) sizes.emplace_back(view.picture.width, view.picture.height);
  return sizes;
}

// True if a judged triangle is positive as the mesh stores it; false if its corners must be swapped.
bool isUpright(const MorphMesh& mesh, const glm::uvec3& t) {
  return (meshSigns(mesh.match, t) & 1u) != 0;
}

// Epipolar directions of all matches, as seen from the frame's centre.
std::vector<std::vector<glm::vec2>> epipolarDirections(std::span<const MatchView> views, const Match& match,
                                                       glm::dvec3 centre) {
  std::vector<std::vector<glm::vec2>> directions(views.size());
  for (std::size_t i = 0; i < views.size(); ++i)
    for (const glm::vec2 at : match[i])
      directions[i].emplace_back(epipolarDirection(views[i].camera, centre, glm::dvec2(at)));
  return directions;
}

// Planes that contain all three points.
glm::u16vec4 sharedPlanes(const std::vector<glm::u16vec4>& planes, const glm::uvec3& points) {
  glm::u16vec4 shared(0);
  int count = 0;
  const auto has = [&](unsigned point, std::uint16_t plane) {
    const glm::u16vec4& set = planes[point];
    return set.x == plane || set.y == plane || set.z == plane || set.w == plane;
  };
  for (int k = 0; k < 4; ++k) {
    const std::uint16_t plane = planes[points.x][k];
    if (plane != 0 && has(points.y, plane) && has(points.z, plane)) shared[count++] = plane;
  }
  return shared;
}

// Only movable points contribute to the range solve.
std::vector<std::uint8_t> movableFlags(std::vector<std::uint8_t> fixed) {
  for (std::uint8_t& point : fixed) point = !point;
  return fixed;
}

}  // namespace

MatchedSize::MatchedSize(std::span<const MatchView> views) : views_(views) {
  for (const MatchView& view : views) {
    cameras_.push_back(matchedCamera(view.camera));
    const Intrinsics &now = cameras_.back().intrinsics, &stored = view.camera.intrinsics;
    scale_.emplace_back(double(now.width) / stored.width, double(now.height) / stored.height);
  }
}

std::vector<std::vector<glm::dvec2>> MatchedSize::match(const Match& stored) const {
  std::vector<std::vector<glm::dvec2>> match(stored.size());
  for (std::size_t i = 0; i < match.size(); ++i)
    for (const glm::vec2 at : stored[i]) match[i].push_back(pixel(i, at));
  return match;
}

std::vector<float> MatchedSize::labels(const Match& stored, std::span<const glm::uvec3> triangles) const {
  std::vector<Image8> small;
  small.reserve(views_.size());
  std::vector<const Image8*> pictures;
  Match member = stored;
  for (std::size_t i = 0; i < views_.size(); ++i) {
    const Intrinsics& k = cameras_[i].intrinsics;
    const Image8& whole = views_[i].picture;
    const bool asIs = k.width == whole.width && k.height == whole.height;
    pictures.push_back(asIs ? &whole : &small.emplace_back(downscaled(whole, k.width, k.height)));
    for (glm::vec2& at : member[i]) at = glm::vec2(pixel(i, at));
  }
  return worstPairEcc(pictures, member, triangles);
}

PictureAlignment::PictureAlignment(std::span<const MatchView> views, const MorphMesh& mesh, const Camera& frame,
                                   bool widened, const std::vector<std::uint8_t>& fixed)
    : views_(views),
      mesh_(mesh),
      matched_(views),
      grid_(toAlignmentGrid(mesh, sizesOf(views), fixed)),
      ranges_(frame, matched_.cameras(), mesh, matched_.match(mesh.match), widened, movableFlags(fixed)) {
  for (const MatchView& view : views) grid_.alignment.pictures.push_back(&view.picture);
  grid_.alignment.epipolar = epipolarDirections(views, mesh.match, frame.pose.position);
}

Match PictureAlignment::run(const AlignmentOptions& options, const Aligner& aligner, const ProgressCallback& progress) {
  summary_ = emptySummary(mesh_.vertexCount());
  if (judged() == 0) return mesh_.match;
  AlignmentOptions guarded = options;
  guarded.guard = [this](std::uint32_t point, std::span<const glm::ivec2> position) { return allows(point, position); };
  const auto start = grid_.alignment.position;
  summary_ = aligner(grid_.alignment, guarded, progress);
  return movedMatch(mesh_, start, grid_.alignment.position);
}

std::vector<glm::dvec2> PictureAlignment::pixelsOf(std::size_t point, const Match& match) const {
  std::vector<glm::dvec2> pixels;
  for (std::size_t i = 0; i < match.size(); ++i) pixels.push_back(matched_.pixel(i, match[i][point]));
  return pixels;
}

std::vector<glm::uvec3> PictureAlignment::alignedTriangles() const {
  std::vector<glm::uvec3> triangles = mesh_.triangles;
  for (std::size_t n = 0; n < grid_.judged.size(); ++n) {
    glm::uvec3& t = triangles[grid_.judged[n]];
    const glm::uvec3 aligned = grid_.alignment.triangles[n];
    if (aligned != t && aligned != turned(t)) t = isUpright(mesh_, t) ? aligned : turned(aligned);
  }
  const std::vector<glm::uvec3>& all = grid_.alignment.triangles;
  for (std::size_t n = grid_.judged.size(); n < all.size(); ++n)
    triangles.push_back(isUpright(mesh_, mesh_.triangles[grid_.judged[0]]) ? all[n] : turned(all[n]));
  return triangles;
}

RangeFit PictureAlignment::range(std::size_t point, const Match& match) const {
  return ranges_.solve(point, pixelsOf(point, match));
}

RangeFit PictureAlignment::range(std::size_t point, const Match& match, std::span<const RangeFit> range,
                                 const InsertedPoint& from) const {
  double mean = 0, least = 0, most = 0;
  for (int k = 0; k < 3; ++k) {
    const RangeFit& parent = range[from.parent[k]];
    const double inverseDepth = parent.inverseDistance / parent.perInverseDepth;
    mean += from.weight[k] * inverseDepth;
    least = k == 0 ? inverseDepth : std::min(least, inverseDepth);
    most = std::max(most, inverseDepth);
  }
  return ranges_.solve(mean, most - least, pixelsOf(point, match));
}

bool PictureAlignment::allows(std::uint32_t point, std::span<const glm::ivec2> position) const {
  std::vector<glm::dvec2> pixels;
  for (std::size_t i = 0; i < position.size(); ++i)
    pixels.push_back(matched_.pixel(i, glm::dvec2(position[i]) / double(kAlignmentUnitsPerPixel)));
  const double most = kMaxResidualPx * matched_.pixelsPerStored();
  if (point >= mesh_.vertexCount()) {
    const RangeFit inserted = ranges_.solve(pixels);
    return inserted.inverseDistance > 0 && inserted.residualPx <= most;
  }
  const RangeFit &was = before(point), now = ranges_.solve(point, pixels);
  if (was.inverseDistance > 0 && !(now.inverseDistance > 0)) return false;  // rays no longer intersect in front
  return now.residualPx <= std::max(most, was.residualPx);
}

AlignmentSummary emptySummary(std::size_t points) {
  AlignmentSummary none;
  none.initialEcc = none.finalEcc = none.initialEccPaper = none.finalEccPaper = std::nan("");
  none.initialStarEcc.assign(points, std::nanf(""));
  none.finalStarEcc = none.initialStarEcc;
  return none;
}

std::size_t revertFolded(const MorphMesh& mesh, Match& moved, const Signs& signs) {
  std::vector<bool> back(mesh.vertexCount(), false);
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

std::size_t revertFolded(const MorphMesh& before, MorphMesh& now) {
  const std::vector<std::size_t> changed = changedTriangles(before, now);
  MorphMesh others = before;
  for (const std::size_t t : changed)
    if (t < others.triangles.size()) others.triangles[t] = glm::uvec3(0);  // never positive: blocks no move
  Match match = now.match;
  std::size_t back = revertFolded(others, match, meshSigns);
  const bool stand = std::ranges::all_of(changed, [&](std::size_t t) {
    const glm::uvec3 was = before.triangles[t < before.triangles.size() ? t : changed[0]], is = now.triangles[t];
    return meshSigns(match, isUpright(before, was) ? is : turned(is)) == allPositive(match.size());
  });
  if (!stand) {
    now.triangles = before.triangles;
    match = now.match;
    for (auto& at : match) at.resize(before.vertexCount());
    back = revertFolded(before, match, meshSigns);
  }
  now.match = std::move(match);
  return back;
}

std::vector<bool> movedPoints(const Match& before, const Match& after) {
  std::vector<bool> moved(before[0].size(), false);
  for (std::size_t i = 0; i < before.size(); ++i)
    for (std::size_t p = 0; p < before[i].size(); ++p)
      if (before[i][p] != after[i][p]) moved[p] = true;
  moved.resize(after[0].size(), true);
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

std::vector<std::size_t> changedTriangles(const MorphMesh& before, const MorphMesh& now) {
  std::vector<std::size_t> changed;
  for (std::size_t t = 0; t < now.triangles.size(); ++t)
    if (t >= before.triangles.size() || now.triangles[t] != before.triangles[t]) changed.push_back(t);
  return changed;
}

void extendLists(MorphMesh& mesh, std::span<const InsertedPoint> inserted) {
  mesh.tier.resize(mesh.triangles.size(), kTierConsistent);
  mesh.ecc.resize(mesh.triangles.size(), 0.0f);
  for (const InsertedPoint& point : inserted) {
    mesh.inverseDistance.push_back(0.0f);
    mesh.uncertainty.push_back(0.0f);
    for (auto& ratio : mesh.ratio) ratio.push_back(1.0f);
    if (!mesh.planes.empty()) mesh.planes.push_back(sharedPlanes(mesh.planes, point.parent));
  }
}

void sortByTier(MorphMesh& mesh) {
  const auto first = std::ranges::find_if(mesh.tier, [](std::uint8_t tier) { return tier != kTierConsistent; });
  const auto last = std::find(first, mesh.tier.end(), std::uint8_t(kTierConsistent));
  const auto rotate = [&](auto& list) {
    std::rotate(list.begin() + (first - mesh.tier.begin()), list.begin() + (last - mesh.tier.begin()), list.end());
  };
  rotate(mesh.triangles);
  rotate(mesh.ecc);
  std::rotate(first, last, mesh.tier.end());
}

void updateRanges(MorphMesh& mesh, const std::vector<bool>& moved, std::span<const RangeFit> range,
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

CellQuality qualityOf(const MorphMesh& mesh, CellQuality quality, std::vector<double> residuals,
                      const std::function<double(const glm::uvec3&)>& area) {
  double covered = 0, weighted = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (mesh.tier[t] != kTierConsistent) continue;
    const double size = area(mesh.triangles[t]);
    covered += size;
    weighted += size * double(mesh.ecc[t]);
  }
  const double before = quality.ecc;
  if (covered > 0) quality.ecc = std::clamp(weighted / covered, -1.0, 1.0);
  if (before > 0) quality.score = std::min(quality.score * std::max(quality.ecc, 0.0) / before, 1.0);
  if (!residuals.empty()) quality.residualPx = median(residuals);
  return quality;
}

}  // namespace aligning

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
  OptimisedCell& facts = result.facts;
  facts.points = before.vertexCount();
  facts.evaluated = alignment.judged();
  facts.fixed = alignment.fixed();
  facts.summary = alignment.summary();
  facts.reverted = aligning::revertFolded(before, mesh);
  facts.inserted = mesh.match[0].size() - facts.points;
  if (facts.inserted == 0 && facts.summary.insertions > 0) {  // undone, along with all flips
    facts.summary.insertions = facts.summary.flips = 0;
    facts.summary.initialStarEcc.resize(facts.points);
    facts.summary.finalStarEcc.resize(facts.points);
  }
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
  std::vector<RangeFit> range;
  std::vector<double> level, residuals;
  for (std::size_t p = 0; p < mesh.vertexCount(); ++p) {
    range.push_back(p >= facts.points ? alignment.range(p, mesh.match, range, inserted[p - facts.points])
                    : moved[p]        ? alignment.range(p, mesh.match)
                                      : alignment.before(p));
    level.push_back(alignment.level() * range[p].perInverseDepth);
    residuals.push_back(range[p].residualPx);
  }
  aligning::updateRanges(mesh, moved, range, level);
  std::vector<std::size_t> changed;
  std::ranges::set_union(aligning::movedTriangles(mesh, moved), joined, std::back_inserter(changed));
  std::vector<glm::uvec3> corners;
  for (const std::size_t t : changed) corners.push_back(mesh.triangles[t]);
  const std::vector<float> ecc = matched.labels(mesh.match, corners);
  for (std::size_t t = 0; t < changed.size(); ++t) mesh.ecc[changed[t]] = ecc[t];
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
