// SPDX-License-Identifier: Apache-2.0
#include "author/align/picture_alignment.h"

#include <algorithm>
#include <cmath>

#include "author/align/aligned_mesh.h"
#include "author/geometry/epipolar_direction.h"
#include "author/geometry/mesh_signs.h"
#include "author/geometry/posed_model.h"
#include "author/mesh/label.h"
#include "ibr/author/photographs.h"

namespace ibr::aligning {
namespace {

constexpr double kMaxResidualPx = 3;  // px of stored photographs

std::vector<glm::ivec2> sizesOf(std::span<const MatchView> views) {
  std::vector<glm::ivec2> sizes;
  for (const MatchView& view : views) sizes.emplace_back(view.picture.width, view.picture.height);
  return sizes;
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

}  // namespace ibr::aligning
