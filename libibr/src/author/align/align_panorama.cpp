// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>

#include "author/align/align_cell.h"
#include "author/align/aligned_mesh.h"
#include "author/align/picture_alignment.h"
#include "author/geometry/posed_model.h"
#include "author/panorama/panorama_faces.h"

namespace ibr {
namespace {

using aligning::Match;
using aligning::PictureAlignment;

constexpr unsigned kNone = ~0u;
constexpr double kMinBorderPx = 2;     // minimum distance of a point from the border of its face
constexpr int kMaxFaceSizePx = 16384;  // px

glm::dvec3 rayOf(const Camera& camera, glm::vec2 pixel) {
  return camera.pose.rotation * unproject(camera.intrinsics, glm::dvec2(pixel));
}

class Sphere {
 public:
  Sphere(const CellAlignmentInput& input, const AlignmentOptions& options, const Aligner& aligner,
         const ProgressCallback& progress)
      : input_(input), options_(options), aligner_(aligner), progress_(progress), before_(input.cell.mesh) {
    options_.flipEdges = options_.insertPoints = false;
    for (const MatchView& view : input.views) samplers_.emplace_back(view.picture);
    for (const glm::dquat turn : cubeRotations()) rotations_.push_back(input.views[0].camera.pose.rotation * turn);
    for (std::size_t p = 0; p < before_.vertexCount(); ++p) {
      glm::dvec3 mean(0.0);
      for (std::size_t i = 0; i < before_.memberCount(); ++i) mean += rayOf(input.views[i].camera, before_.match[i][p]);
      faceOf_.push_back(cubeFaceTowards(mean));
    }
    trianglesOf_.resize(before_.vertexCount());
    for (std::size_t t = 0; t < before_.triangles.size(); ++t)
      for (int k = 0; k < 3; ++k) trianglesOf_[before_.triangles[t][k]].push_back(t);
  }

  AlignedCell run() {
    AlignedCell result{before_, input_.cell.quality, {}};
    MorphMesh& mesh = result.mesh;
    OptimisedCell& facts = result.facts;
    facts.points = before_.vertexCount();
    summary_ = aligning::emptySummary(facts.points);
    range_.resize(facts.points);
    for (unsigned f = 0; f < rotations_.size(); ++f) alignFace(f, mesh.match, facts);
    finishSummary();
    facts.summary = std::move(summary_);
    const std::vector<bool> moved = aligning::movedPoints(before_.match, mesh.match);
    facts.moved = std::size_t(std::ranges::count(moved, true));
    facts.fixed = facts.points - movable_;
    if (facts.moved == 0) return result;
    aligning::updateRanges(mesh, moved, range_, {});
    label(mesh, moved);
    result.quality = aligning::qualityOf(mesh, input_.cell.quality, residuals_, [&](const glm::uvec3& t) {
      std::array<glm::dvec3, 3> corner{};
      for (int k = 0; k < 3; ++k) corner[std::size_t(k)] = glm::normalize(meanRay(mesh.match, t[k]));
      return std::abs(solidAngle(corner[0], corner[1], corner[2]));
    });
    return result;
  }

 private:
  unsigned cubeFaceTowards(glm::dvec3 direction) const {
    unsigned best = 0;
    const auto towards = [&](unsigned f) { return glm::dot(rotations_[f] * glm::dvec3(0, 0, -1), direction); };
    for (unsigned f = 1; f < rotations_.size(); ++f)
      if (towards(f) > towards(best)) best = f;
    return best;
  }
  glm::dvec3 meanRay(const Match& match, std::size_t p) const {
    glm::dvec3 mean(0.0);
    for (std::size_t i = 0; i < match.size(); ++i) mean += rayOf(input_.views[i].camera, match[i][p]);
    return mean;
  }

  std::vector<MatchView> viewsOf(unsigned f) const {
    std::vector<MatchView> views;
    for (std::size_t i = 0; i < input_.views.size(); ++i) {
      const Camera& camera = input_.views[i].camera;
      const int size = std::min(faceSize(camera.intrinsics.width, kMatchedFaceFov), kMaxFaceSizePx);
      const Intrinsics intrinsics = faceIntrinsics(size, kMatchedFaceFov);
      const glm::dquat turn = glm::conjugate(camera.pose.rotation) * rotations_[f];
      views.push_back({{intrinsics, {camera.pose.position, rotations_[f]}}, samplers_[i].view(intrinsics, turn)});
    }
    return views;
  }

  // Points in px of a face, and flags: well inside the face for all members.
  struct FacePoints {
    Match match;
    std::vector<bool> inside;
  };
  FacePoints facePoints(const std::vector<MatchView>& views, const Match& match) const {
    FacePoints result{Match(views.size()), std::vector<bool>(before_.vertexCount(), true)};
    for (std::size_t i = 0; i < views.size(); ++i) {
      const Intrinsics& k = views[i].camera.intrinsics;
      for (std::size_t p = 0; p < before_.vertexCount(); ++p) {
        const glm::dvec3 ray = rayOf(input_.views[i].camera, match[i][p]);
        const auto at = project(k, glm::conjugate(views[i].camera.pose.rotation) * ray);
        const bool in = at && at->x >= kMinBorderPx && at->y >= kMinBorderPx && at->x <= k.width - kMinBorderPx &&
                        at->y <= k.height - kMinBorderPx;
        result.match[i].push_back(in ? glm::vec2(*at) : glm::vec2(0.0f));
        if (!in) result.inside[p] = false;
      }
    }
    return result;
  }

  void alignFace(unsigned f, Match& match, OptimisedCell& facts) {
    const std::vector<MatchView> views = viewsOf(f);
    const FacePoints at = facePoints(views, match);
    const auto within = [&](std::size_t t) {
      const glm::uvec3& corner = before_.triangles[t];
      return at.inside[corner.x] && at.inside[corner.y] && at.inside[corner.z];
    };
    // The part of the mesh around the movable points of this face.
    std::vector<unsigned> number(before_.vertexCount(), kNone), point;
    std::vector<std::uint8_t> fixed;
    std::vector<bool> taken(before_.triangles.size(), false);
    MorphMesh part;
    const auto add = [&](unsigned p, bool moves) {
      if (number[p] == kNone) {
        number[p] = unsigned(point.size());
        point.push_back(p);
        fixed.push_back(1);
      }
      if (moves) fixed[number[p]] = 0;
    };
    for (unsigned p = 0; p < before_.vertexCount(); ++p) {
      if (faceOf_[p] != f || !at.inside[p] || !std::ranges::all_of(trianglesOf_[p], within)) continue;
      add(p, true);
      for (const std::size_t t : trianglesOf_[p]) {
        taken[t] = true;
        for (int k = 0; k < 3; ++k) add(before_.triangles[t][k], false);
      }
    }
    for (std::size_t t = 0; t < taken.size(); ++t) {
      if (!taken[t]) continue;
      const glm::uvec3& corner = before_.triangles[t];
      part.triangles.emplace_back(number[corner.x], number[corner.y], number[corner.z]);
      part.tier.push_back(before_.tier[t]);
    }
    if (point.empty()) return;
    part.match.resize(views.size());
    part.ratio.resize(views.size());
    for (const unsigned p : point) {
      part.inverseDistance.push_back(before_.inverseDistance[p]);
      part.uncertainty.push_back(before_.uncertainty[p]);
      for (std::size_t i = 0; i < views.size(); ++i) {
        part.match[i].push_back(at.match[i][p]);
        part.ratio[i].push_back(before_.ratio[i][p]);
      }
    }

    glm::dvec3 centre(0.0);
    for (const MatchView& view : views) centre += view.camera.pose.position / double(views.size());
    const Camera frame = matchedCamera({views[0].camera.intrinsics, {centre, rotations_[f]}});
    PictureAlignment alignment(views, part, frame, false, fixed);
    const Match to = alignment.run(options_, aligner_, [&](const Progress& p) {
      return !progress_ ||
             progress_({p.stage, p.done + f * kExpectedCycles, kExpectedCycles * rotations_.size() + p.done});
    });
    for (std::size_t v = 0; v < point.size(); ++v)
      for (std::size_t i = 0; i < views.size(); ++i)
        if (to[i][v] != part.match[i][v])
          match[i][point[v]] = onSphere(views[i].camera, i, to[i][v], match[i][point[v]]);
    facts.reverted +=
        aligning::revertFolded(before_, match, [this](const Match& m, const glm::uvec3& t) { return signs(m, t); });
    facts.evaluated += alignment.judged();
    note(alignment, to, point, fixed);
  }

  glm::vec2 onSphere(const Camera& face, std::size_t member, glm::vec2 pixel, glm::vec2 otherwise) const {
    const Camera& camera = input_.views[member].camera;
    const auto at = project(camera.intrinsics, glm::conjugate(camera.pose.rotation) * rayOf(face, pixel));
    return at ? glm::vec2(*at) : otherwise;
  }

  // As meshSigns, but for directions: signs in each member, in the mean of each pair, and in the mean of all.
  std::uint32_t signs(const Match& match, const glm::uvec3& t) const {
    constexpr double kMinDeterminant = 1e-13;  // beyond rounding errors of a determinant
    std::vector<glm::dmat3> corner;
    glm::dmat3 sum(0.0);
    std::uint32_t signs = 0, bit = 1;
    const auto note = [&](const glm::dmat3& m) {
      if (glm::determinant(m) > kMinDeterminant) signs |= bit;
      bit <<= 1;
    };
    for (std::size_t i = 0; i < match.size(); ++i) {
      const Camera& camera = input_.views[i].camera;
      corner.emplace_back(rayOf(camera, match[i][t.x]), rayOf(camera, match[i][t.y]), rayOf(camera, match[i][t.z]));
      note(corner[i]);
      for (std::size_t j = 0; j < i; ++j) note(corner[i] + corner[j]);
      sum += corner[i];
    }
    note(sum);
    return signs;
  }

  void note(const PictureAlignment& alignment, const Match& to, const std::vector<unsigned>& point,
            const std::vector<std::uint8_t>& fixed) {
    const AlignmentSummary& own = alignment.summary();
    double stars = 0;
    for (std::size_t v = 0; v < point.size(); ++v) {
      if (!std::isnan(own.initialStarEcc[v])) ++stars;
      if (fixed[v]) continue;
      ++movable_;
      range_[point[v]] = alignment.range(v, to);
      residuals_.push_back(range_[point[v]].residualPx);
      summary_.initialStarEcc[point[v]] = own.initialStarEcc[v];
      summary_.finalStarEcc[point[v]] = own.finalStarEcc[v];
    }
    if (std::isnan(own.initialEcc)) return;
    stars_ += stars;
    initialPaper_ += stars * own.initialEccPaper;
    finalPaper_ += stars * own.finalEccPaper;
    summary_.seconds += own.seconds;
    summary_.bestCycle = std::max(summary_.bestCycle, own.bestCycle);
    for (std::size_t c = 0; c < own.cycles.size(); ++c) {
      if (summary_.cycles.size() == c) summary_.cycles.push_back({own.cycles[c].radiusPx});
      AlignmentCycle& all = summary_.cycles[c];
      const AlignmentCycle& one = own.cycles[c];
      all.ecc += stars * one.ecc;
      cycleStars_.resize(summary_.cycles.size(), 0);
      cycleStars_[c] += stars;
      all.mutations += one.mutations;
      all.pixels += one.pixels;
      all.moved += one.moved;
      all.refused += one.refused;
      all.seconds += one.seconds;
    }
  }

  void finishSummary() {
    if (stars_ == 0) return;
    summary_.initialEccPaper = initialPaper_ / stars_;
    summary_.finalEccPaper = finalPaper_ / stars_;
    for (std::size_t c = 0; c < summary_.cycles.size(); ++c) summary_.cycles[c].ecc /= cycleStars_[c];
    double before = 0, after = 0, count = 0;
    for (std::size_t p = 0; p < before_.vertexCount(); ++p) {
      if (std::isnan(summary_.initialStarEcc[p])) continue;
      before += double(summary_.initialStarEcc[p]);
      after += double(summary_.finalStarEcc[p]);
      ++count;
    }
    if (count == 0) return;
    summary_.initialEcc = before / count;
    summary_.finalEcc = after / count;
  }

  // A triangle is labelled in the face that contains its middle. If a corner lies outside that face, the label stays.
  void label(MorphMesh& mesh, const std::vector<bool>& moved) const {
    const std::vector<std::size_t> changed = aligning::movedTriangles(mesh, moved);
    for (unsigned f = 0; f < rotations_.size(); ++f) {
      const std::vector<MatchView> views = viewsOf(f);
      const FacePoints at = facePoints(views, mesh.match);
      std::vector<std::size_t> number;
      std::vector<glm::uvec3> corners;
      for (const std::size_t t : changed) {
        const glm::uvec3& c = mesh.triangles[t];
        const glm::dvec3 middle = meanRay(mesh.match, c.x) + meanRay(mesh.match, c.y) + meanRay(mesh.match, c.z);
        if (cubeFaceTowards(middle) != f || !at.inside[c.x] || !at.inside[c.y] || !at.inside[c.z]) continue;
        number.push_back(t);
        corners.push_back(c);
      }
      const std::vector<float> ecc = aligning::MatchedSize(views).labels(at.match, corners);
      for (std::size_t n = 0; n < number.size(); ++n) mesh.ecc[number[n]] = ecc[n];
    }
  }

  static constexpr std::size_t kExpectedCycles = 6;  // estimate, for progress reports only

  const CellAlignmentInput& input_;
  AlignmentOptions options_;
  const Aligner& aligner_;
  const ProgressCallback& progress_;
  const MorphMesh& before_;
  std::vector<PanoramaSampler> samplers_;
  std::vector<glm::dquat> rotations_;  // of the faces, to the world
  std::vector<unsigned> faceOf_;       // of each point
  std::vector<std::vector<std::size_t>> trianglesOf_;
  AlignmentSummary summary_;
  std::vector<RangeFit> range_;  // of movable points
  std::vector<double> residuals_, cycleStars_;
  double stars_ = 0, initialPaper_ = 0, finalPaper_ = 0;
  std::size_t movable_ = 0;
};

}  // namespace

AlignedCell alignPanoramas(const CellAlignmentInput& input, const AlignmentOptions& options, const Aligner& aligner,
                           const ProgressCallback& progress) {
  return Sphere(input, options, aligner, progress).run();
}

}  // namespace ibr
