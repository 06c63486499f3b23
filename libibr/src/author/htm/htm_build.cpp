// SPDX-License-Identifier: Apache-2.0
// Implements [H] Alg. 2: after Alg. 1 has coarsened the mesh, matches and refines until textures agree.
#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <numeric>
#include <utility>

#include "author/htm/htm_adjust.h"
#include "author/htm/htm_checks.h"
#include "author/htm/htm_collapse.h"
#include "author/htm/htm_complements.h"
#include "author/htm/htm_consensus.h"
#include "author/htm/htm_difference.h"
#include "author/htm/htm_evaluate.h"
#include "author/htm/htm_match.h"
#include "author/htm/htm_reduce.h"
#include "author/htm/htm_reject.h"
#include "author/htm/htm_shape.h"
#include "author/htm/htm_subdivide.h"
#include "author/htm/htm_visibility.h"
#include "author/jobs/build_jobs.h"
#include "base/check.h"
#include "base/stopwatch.h"
#include "ibr/author/htm.h"

namespace ibr {
namespace {

double mean(std::span<const double> values) {
  return values.empty() ? 0 : std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
}

// A mesh, projected into all cameras, and the visibility of its faces.
struct ViewedMesh {
  std::vector<ProjectedMesh> views;
  std::vector<FaceVisibility> faces;
};

class Harmoniser {
  // Measures a stage's time and reports progress.
  template <class Work>
  auto timed(const char* name, Work&& work) {
    jobs_.step(name, 0, 1);
    const Stopwatch watch;
    auto value = work();
    auto& stages = result_.report.stages;
    auto stage = std::ranges::find(stages, name, &HtmReport::Stage::name);
    if (stage == stages.end()) stage = stages.insert(stages.end(), {name, 0});
    stage->seconds += watch.seconds();
    jobs_.step(name, 1, 1);
    return value;
  }

 public:
  Harmoniser(std::span<const HtmPhotograph> photographs, const HtmOptions& options, const ProgressCallback& progress)
      : options_(options), progress_(progress), jobs_(options.threads, 0, progress) {
    for (const HtmPhotograph& p : photographs) views_.push_back({p.camera.camera, p.picture, p.mask});
  }

  HtmResult run(const TriangleMesh& source, std::span<const HtmPhotograph> photographs) {
    HtmReport& report = result_.report;
    report.sourceFaces = source.triangles.size();
    ViewedMesh original = timed("visibility", [&] { return viewed(source); });
    check(std::ranges::any_of(original.faces, [](const FaceVisibility& f) { return f.seen != 0; }),
          ErrorCode::invalidInput, "harmonise: no camera sees a face of the mesh");
    recordStage("original", source, differences(source, original, {}));
    original.views.clear();  // large

    TriangleMesh mesh = reducedByShape(source);
    adjustGeometry(mesh);
    mesh = reducedByTexture(std::move(mesh));
    refine(mesh);
    for (std::size_t i = 0; i < photographs.size(); ++i) {
      result_.model.cameras.push_back(photographs[i].camera);
      HtmCamera& camera = result_.model.cameras.back();
      if (options_.adjustRounds > 0) camera.given = std::exchange(camera.camera, views_[i].camera);
    }
    if (options_.keepSource) result_.model.source = HtmSurface{source, vertexVisibility(source, original.faces)};
    finish(mesh);
    return std::move(result_);
  }

 private:
  ViewedMesh viewed(const TriangleMesh& mesh) const {
    ViewedMesh viewed{projectedMeshes(mesh, views_, 0, options_.threads), {}};
    viewed.faces = faceVisibility(mesh, viewed.views, options_.threads);
    return viewed;
  }

  std::vector<double> differences(const TriangleMesh& mesh, const ViewedMesh& viewed,
                                  std::span<const glm::vec2> complements) {
    std::vector<std::uint32_t> all(mesh.triangles.size());
    std::iota(all.begin(), all.end(), 0u);
    return timed("differences", [&] {
      return faceDifferences(mesh, viewed.views, viewed.faces, complements, all, {options_.alpha, options_.gamma1},
                             options_.threads);
    });
  }

  void recordStage(const char* name, const TriangleMesh& mesh, std::vector<double> difference) {
    result_.stages.push_back({name, mesh, std::move(difference)});
  }

  TriangleMesh reducedByShape(const TriangleMesh& source) {
    HtmReduceOptions reduce;
    reduce.faceCount = options_.faces > 0 ? options_.faces : source.triangles.size();
    reduce.progress = progress_;
    ReducedMesh reduced = timed("reduction by shape", [&] { return reduceMesh(source, reduce); });
    HtmReport& report = result_.report;
    report.reducedFaces = reduced.mesh.triangles.size();
    report.reducedMean = reduced.report.toReduced.mean;
    report.reducedMax = reduced.report.toReduced.max;
    report.restoredMean = reduced.report.toOriginal.mean;
    report.restoredMax = reduced.report.toOriginal.max;
    meanFaceArea_ = reduced.report.meanFaceArea;
    return std::move(reduced.mesh);
  }

  TriangleMesh reducedByTexture(TriangleMesh mesh) {
    std::vector<double> difference = differences(mesh, timed("visibility", [&] { return viewed(mesh); }), {});
    HtmReport& report = result_.report;
    report.reducedDifference = report.collapsedDifference = mean(difference);
    recordStage("reduced by shape", mesh, difference);
    const auto most = std::size_t(options_.inconsistentShare * double(mesh.triangles.size()));
    if (!(options_.inconsistentSize > 0) || most == 0) return mesh;
    HtmCollapseOptions collapse;
    collapse.faceArea = options_.inconsistentSize * meanFaceArea_;
    collapse.floor = options_.inconsistentDifference;
    collapse.maxCollapses = most;
    collapse.batch = std::max<std::size_t>(1, most / 16);  // visibility is computed again before each batch
    collapse.progress = progress_;
    CollapsedMesh collapsed = timed("reduction by texture", [&] {
      return collapseDifferences(
          mesh,
          [&](const TriangleMesh& now, std::span<const std::uint32_t> faces) {
            const ViewedMesh seen = viewed(now);
            return faceDifferences(now, seen.views, seen.faces, {}, faces, {options_.alpha, options_.gamma1},
                                   options_.threads);
          },
          collapse);
    });
    report.collapses = collapsed.report.collapses;
    report.collapsedDifference = mean(collapsed.differences);
    recordStage("reduced by texture", collapsed.mesh, std::move(collapsed.differences));
    return std::move(collapsed.mesh);
  }

  void refine(TriangleMesh& mesh) {
    for (int round = 1;; ++round) {
      const ViewedMesh now = timed("visibility", [&] { return viewed(mesh); });
      members_ = vertexVisibility(mesh, now.faces);
      match(mesh, now);
      solve(mesh);
      near_ = true;
      const std::vector<double> without = differences(mesh, now, {}), with = differences(mesh, now, complements_);
      EvaluatedFaces evaluated;
      if (round < options_.rounds && mesh.triangles.size() < options_.maxFaces)
        evaluated = evaluateFaces(
            mesh, now.views, now.faces, with,
            {options_.meanDifference, options_.faceDifference, options_.selfOccluded, options_.minFacePx});
      result_.report.rounds.push_back({mesh.positions.size(), mesh.triangles.size(), mean(without), mean(with),
                                       measured(), evaluated.divided, evaluated.hidden});
      if (evaluated.divided == 0) {
        recordStage("refined", mesh, with);
        return;
      }
      timed("subdivision", [&] {
        SubdividedMesh divided = subdivideFaces(mesh, evaluated.divide);
        complements_ = dividedComplements(complements_, views_.size(), mesh.positions.size(), divided.parents);
        mesh = std::move(divided.mesh);
        return 0;
      });
    }
  }

  // Adjusts the cameras and then the shape to the matches, adjustRounds times, each time with new matches.
  void adjustGeometry(TriangleMesh& mesh) {
    for (int round = 0; round < options_.adjustRounds; ++round) {
      const ViewedMesh now = timed("visibility", [&] { return viewed(mesh); });
      members_ = vertexVisibility(mesh, now.faces);
      match(mesh, now);
      HtmReport::Adjustment& line = result_.report.adjustments.emplace_back();
      timed("adjustment", [&] {
        const std::size_t known = adjustCameras(mesh, line);
        near_ = known == views_.size();
        // Without adjusted cameras the shape would absorb the cameras' errors.
        if (options_.reshape && known > 0) reshape(mesh, line);
        return 0;
      });
    }
  }

  // Returns the number of cameras with enough vertices to be adjusted.
  std::size_t adjustCameras(const TriangleMesh& mesh, HtmReport::Adjustment& line) {
    const std::vector<AdjustedCamera> adjusted = adjustedCameras(
        mesh, views_, members_,
        consensusOffsets(mesh, views_, members_, matches_,
                         {.smoothness = options_.adjustSmoothness, .outlierPx = options_.outlierPx}, progress_));
    const std::size_t n = mesh.positions.size();
    std::vector<glm::vec2> shifts(views_.size() * n, glm::vec2(0.0f));  // of projected vertices, by the cameras' moves
    for (std::size_t i = 0; i < views_.size(); ++i) {
      line.beforePx += adjusted[i].beforePx / double(views_.size());
      line.afterPx += adjusted[i].afterPx / double(views_.size());
      const PinholeView before(views_[i].camera), after(adjusted[i].camera);
      for (std::size_t v = 0; v < n; ++v)
        if (const auto from = before.seen(mesh.positions[v]), to = after.seen(mesh.positions[v]); from && to)
          shifts[i * n + v] = glm::vec2(to->pixel - from->pixel);
      views_[i].camera = adjusted[i].camera;
    }
    // Subtract the displacements that the adjusted cameras explain: the rest is left to the shape.
    const std::vector<glm::vec2> explained = consistentComplements(mesh, views_, members_, shifts);
    for (std::size_t k = 0; k < matches_.size(); ++k) matches_[k].displacement -= explained[k];
    return std::size_t(std::ranges::count(adjusted, true, &AdjustedCamera::known));
  }

  void reshape(TriangleMesh& mesh, HtmReport::Adjustment& line) const {
    TriangleMesh moved = displaced(
        mesh, normalDisplacements(mesh, views_, members_, matches_,
                                  {options_.shapeSmoothness, options_.outlierPx, options_.threads}, progress_));
    for (std::size_t v = 0; v < mesh.positions.size(); ++v)
      line.meanDisplacement += glm::distance(moved.positions[v], mesh.positions[v]) / double(mesh.positions.size());
    mesh = std::move(moved);
  }

  void match(const TriangleMesh& mesh, const ViewedMesh& now) {
    VertexMatchOptions how;
    how.measure = options_.measure;
    how.radius = near_ ? options_.laterRadius : options_.radius;
    how.minTexture = options_.minTexture;
    how.threads = options_.threads;
    const TemplateSearchFactory search = options_.search ? options_.search : cpuTemplateSearch;
    matches_ = timed("matching", [&] {
      return matchVertices(mesh, views_, now.views, members_, complements_, how, search, progress_);
    });
  }

  void solve(const TriangleMesh& mesh) {
    complements_ = timed("complements", [&] {
      return complementsOf(mesh, views_.size(), members_, matches_,
                           {options_.smoothness, options_.outlierPx, options_.threads, options_.complementPx});
    });
  }

  double measured() const {
    std::size_t pairs = 0, known = 0;
    for (const CameraSet set : members_)
      pairs += std::size_t(std::popcount(set)) * std::size_t(std::popcount(set) - (set != 0));
    for (const VertexMatch& match : matches_) known += match.information.x + match.information.z > 0;
    return pairs > 0 ? double(known) / double(pairs) : 0;
  }

  void finish(TriangleMesh& mesh) {
    const ViewedMesh last = timed("visibility", [&] { return viewed(mesh); });
    HtmReport& report = result_.report;
    std::size_t seen = 0, left = 0;
    for (const CameraSet set : members_) seen += std::size_t(std::popcount(set));
    if (options_.reject) {
      timed("rejection", [&] {
        RejectOptions how;
        how.maxDifference = options_.rejectDifference;
        how.minCorrelation = options_.rejectCorrelation;
        const std::vector<CameraAgreement> known =
            agreements(mesh, last.views, members_, complements_, how.segment, options_.threads);
        members_ = agreeingMembers(views_.size(), members_, known, facingScores(mesh, last.views), how);
        return 0;
      });
      solve(mesh);
    }
    for (const CameraSet set : members_) left += std::size_t(std::popcount(set));
    report.camerasPerVertex = double(seen) / double(std::max<std::size_t>(1, members_.size()));
    report.rejected = seen > 0 ? double(seen - left) / double(seen) : 0;
    for (const ProjectedMesh& view : last.views) result_.visibility.push_back(softVisibility(view, options_.softPx));
    result_.model.surface = {std::move(mesh), std::move(members_)};
    result_.model.complements = std::move(complements_);
    report.complementBytes = result_.model.complements.size() * sizeof(glm::vec2);
  }

  const HtmOptions& options_;
  const ProgressCallback& progress_;
  BuildJobs jobs_;
  std::vector<HtmView> views_;
  double meanFaceArea_ = 0;  // of the mesh after reduction by shape
  bool near_ = false;        // matches are expected near the start of the search: laterRadius is enough
  std::vector<CameraSet> members_;
  std::vector<VertexMatch> matches_;
  std::vector<glm::vec2> complements_;  // also the start of the next round's search
  HtmResult result_;
};

}  // namespace

HtmResult harmonise(const TriangleMesh& mesh, std::span<const HtmPhotograph> photographs, const HtmOptions& options,
                    const ProgressCallback& progress) {
  checkHtmOptions(options);
  checkHtmMesh(mesh);
  checkHtmPhotographs(photographs);
  return Harmoniser(photographs, options, progress).run(mesh, photographs);
}

}  // namespace ibr
