// SPDX-License-Identifier: Apache-2.0
// [H] Alg. 2: matching and refining until textures agree, after Alg. 1 has made the mesh coarse.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numeric>
#include <utility>

#include "author/build_jobs.h"
#include "author/htm_adjust.h"
#include "author/htm_collapse.h"
#include "author/htm_complements.h"
#include "author/htm_consensus.h"
#include "author/htm_difference.h"
#include "author/htm_match.h"
#include "author/htm_reduce.h"
#include "author/htm_reject.h"
#include "author/htm_shape.h"
#include "author/htm_subdivide.h"
#include "author/htm_visibility.h"
#include "author/stopwatch.h"
#include "base/check.h"
#include "ibr/htm_author.h"

namespace ibr {
namespace {

double mean(std::span<const double> values) {
  return values.empty() ? 0 : std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
}

void checkOptions(const HtmOptions& o) {
  const auto inRange = [](const char* name, double value, double low, double high) {
    check(value >= low && value <= high, ErrorCode::invalidInput, "harmonise: {} is {}, not within {} to {}", name,
          value, low, high);
  };
  inRange("inconsistentSize", o.inconsistentSize, 0, 1e6);
  inRange("inconsistentDifference", o.inconsistentDifference, 0, 255);
  inRange("inconsistentShare", o.inconsistentShare, 0, 1);
  inRange("adjustRounds", o.adjustRounds, 0, 16);
  inRange("adjustSmoothness", o.adjustSmoothness, 0, 1e6);
  inRange("shapeSmoothness", o.shapeSmoothness, 0, 1e6);
  inRange("radius", o.radius, 1, 2 * kLargestTemplateRadius);
  inRange("laterRadius", o.laterRadius, 1, 2 * kLargestTemplateRadius);
  inRange("leastTexture", o.leastTexture, 0, 255);
  inRange("smoothness", o.smoothness, 0, 1e6);
  inRange("outlierPx", o.outlierPx, 1e-3, 1e6);
  inRange("alpha", o.alpha, 0, 1);
  inRange("gamma1", o.gamma1, 1e-6, 1e6);
  inRange("rounds", o.rounds, 1, 16);
  inRange("meanDifference", o.meanDifference, 0, 255);
  inRange("faceDifference", o.faceDifference, 0, 255);
  inRange("leastFacePx", o.leastFacePx, 0, 1e12);
  inRange("rejectDifference", o.rejectDifference, 0, 255);
  inRange("rejectCorrelation", o.rejectCorrelation, -1, 1);
  inRange("softPx", o.softPx, 1e-3, 1e3);
}

// A mesh with what the cameras see of it.
struct Looked {
  std::vector<ProjectedMesh> views;
  std::vector<FaceVisibility> faces;
};

class Harmoniser {
  // Counts a stage's time and reports it.
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
      : options_(options), progress_(progress), jobs_(options.threads, progress) {
    for (const HtmPhotograph& p : photographs) views_.push_back({p.camera.camera, p.picture, p.mask});
  }

  HtmResult run(const TriangleMesh& source, std::span<const HtmPhotograph> photographs) {
    HtmReport& report = result_.report;
    report.sourceFaces = source.triangles.size();
    const Looked original = timed("visibility", [&] { return looked(source); });
    check(std::ranges::any_of(original.faces, [](const FaceVisibility& f) { return f.seen != 0; }),
          ErrorCode::invalidInput, "harmonise: no camera sees a face of the mesh");
    keepStage("original", source, differences(source, original, {}));

    TriangleMesh mesh = reducedByShape(source);
    settle(mesh);
    mesh = reducedByTexture(std::move(mesh));
    refine(mesh);
    for (std::size_t i = 0; i < photographs.size(); ++i) {
      result_.model.cameras.push_back(photographs[i].camera);
      HtmCamera& camera = result_.model.cameras.back();
      if (options_.adjustRounds > 0) camera.given = std::exchange(camera.camera, views_[i].camera);
    }
    if (options_.keepSource)
      result_.model.source = HtmSurface{source, vertexVisibility(source, original.faces)};
    finish(mesh);
    return std::move(result_);
  }

 private:
  Looked looked(const TriangleMesh& mesh) const {
    Looked looked{projectedMeshes(mesh, views_), {}};
    looked.faces = faceVisibility(mesh, looked.views, options_.threads);
    return looked;
  }

  std::vector<double> differences(const TriangleMesh& mesh, const Looked& looked,
                                  std::span<const glm::vec2> complements) {
    std::vector<std::uint32_t> all(mesh.triangles.size());
    std::iota(all.begin(), all.end(), 0u);
    return timed("differences", [&] {
      return faceDifferences(mesh, looked.views, looked.faces, complements, all, {options_.alpha, options_.gamma1},
                             options_.threads);
    });
  }

  void keepStage(const char* name, const TriangleMesh& mesh, std::vector<double> difference) {
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
    report.reducedMost = reduced.report.toReduced.max;
    report.restoredMean = reduced.report.toOriginal.mean;
    report.restoredMost = reduced.report.toOriginal.max;
    return std::move(reduced.mesh);
  }

  TriangleMesh reducedByTexture(TriangleMesh mesh) {
    const Looked before = timed("visibility", [&] { return looked(mesh); });
    std::vector<double> difference = differences(mesh, before, {});
    HtmReport& report = result_.report;
    report.reducedDifference = report.collapsedDifference = mean(difference);
    keepStage("reduced by shape", mesh, difference);
    const auto most = std::size_t(options_.inconsistentShare * double(mesh.triangles.size()));
    if (!(options_.inconsistentSize > 0) || most == 0) return mesh;
    HtmCollapseOptions collapse;
    collapse.faceArea = options_.inconsistentSize * areaOf(mesh) / double(mesh.triangles.size());
    collapse.floor = options_.inconsistentDifference;
    collapse.mostCollapses = most;
    collapse.batch = std::max<std::size_t>(1, most / 16);  // what hides what is looked at anew before each
    collapse.progress = progress_;
    CollapsedMesh collapsed = timed("reduction by texture", [&] {
      return collapseDifferences(
          mesh,
          [&](const TriangleMesh& now, std::span<const std::uint32_t> faces) {
            const Looked seen = looked(now);
            return faceDifferences(now, seen.views, seen.faces, {}, faces, {options_.alpha, options_.gamma1},
                                   options_.threads);
          },
          collapse);
    });
    report.collapses = collapsed.report.collapses;
    report.collapsedDifference = mean(collapsed.differences);
    keepStage("reduced by texture", collapsed.mesh, std::move(collapsed.differences));
    return std::move(collapsed.mesh);
  }

  static double areaOf(const TriangleMesh& mesh) {
    double area = 0;
    for (const glm::uvec3& t : mesh.triangles) {
      const glm::dvec3& a = mesh.positions[t.x];
      area += 0.5 * glm::length(glm::cross(mesh.positions[t.y] - a, mesh.positions[t.z] - a));
    }
    return area;
  }

  void refine(TriangleMesh& mesh) {
    for (int round = 1;; ++round) {
      const Looked now = timed("visibility", [&] { return looked(mesh); });
      members_ = vertexVisibility(mesh, now.faces);
      match(mesh);
      const std::vector<double> without = differences(mesh, now, {}), with = differences(mesh, now, complements_);
      HtmReport::Round line{mesh.positions.size(), mesh.triangles.size(), mean(without), mean(with), measured(), 0, 0};
      std::vector<std::uint8_t> divide;
      if (round < options_.rounds && mesh.triangles.size() < options_.mostFaces)
        divide = facesToDivide(mesh, now, with, line);
      result_.report.rounds.push_back(line);
      if (line.divided == 0) {
        keepStage("refined", mesh, with);
        return;
      }
      timed("subdivision", [&] {
        divideFaces(mesh, divide);
        return 0;
      });
    }
  }

  // Alg. 7; complements of new vertices begin as the mean of their parents'.
  void divideFaces(TriangleMesh& mesh, std::span<const std::uint8_t> divide) {
    const std::size_t before = mesh.positions.size(), pairs = views_.size() * views_.size();
    SubdividedMesh divided = subdivideFaces(mesh, divide);
    const std::size_t after = divided.mesh.positions.size();
    std::vector<glm::vec2> complements(pairs * after);
    for (std::size_t pair = 0; pair < pairs; ++pair) {
      const glm::vec2* old = &complements_[pair * before];
      std::copy(old, old + before, &complements[pair * after]);
      for (std::size_t k = 0; k < divided.parents.size(); ++k)
        complements[pair * after + before + k] = 0.5f * (old[divided.parents[k].x] + old[divided.parents[k].y]);
    }
    complements_ = std::move(complements);
    mesh = std::move(divided.mesh);
  }

  // Cameras, then the shape, move to where matches say; then all is matched anew.
  void settle(TriangleMesh& mesh) {
    for (int round = 0; round < options_.adjustRounds; ++round) {
      const Looked now = timed("visibility", [&] { return looked(mesh); });
      members_ = vertexVisibility(mesh, now.faces);
      match(mesh);
      HtmReport::Adjustment& line = result_.report.adjustments.emplace_back();
      timed("settling", [&] {
        adjustCameras(mesh, line);
        if (options_.reshape) reshape(mesh, line);
        return 0;
      });
      complements_.clear();
    }
  }

  void adjustCameras(const TriangleMesh& mesh, HtmReport::Adjustment& line) {
    const std::vector<AdjustedCamera> adjusted = adjustedCameras(
        mesh, views_, members_,
        consensusOffsets(mesh, views_, members_, matches_,
                         {.smoothness = options_.adjustSmoothness, .outlierPx = options_.outlierPx}));
    const std::size_t n = mesh.positions.size();
    std::vector<glm::vec2> shifts(views_.size() * n, glm::vec2(0.0f));  // of vertices, by the cameras' moves
    for (std::size_t i = 0; i < views_.size(); ++i) {
      line.beforePx += adjusted[i].beforePx / double(views_.size());
      line.afterPx += adjusted[i].afterPx / double(views_.size());
      const PinholeView before(views_[i].camera), after(adjusted[i].camera);
      for (std::size_t v = 0; v < n; ++v)
        if (const auto from = before.seen(mesh.positions[v]), to = after.seen(mesh.positions[v]); from && to)
          shifts[i * n + v] = glm::vec2(to->pixel - from->pixel);
      views_[i].camera = adjusted[i].camera;
    }
    // What the cameras now explain is no longer the shape's.
    const std::vector<glm::vec2> explained = consistentComplements(mesh, views_, members_, shifts);
    for (std::size_t k = 0; k < matches_.size(); ++k) matches_[k].displacement -= explained[k];
  }

  void reshape(TriangleMesh& mesh, HtmReport::Adjustment& line) const {
    TriangleMesh moved = displaced(mesh, normalDisplacements(mesh, views_, members_, matches_,
                                                             {options_.shapeSmoothness, options_.outlierPx}));
    for (std::size_t v = 0; v < mesh.positions.size(); ++v)
      line.moved += glm::distance(moved.positions[v], mesh.positions[v]) / double(mesh.positions.size());
    mesh = std::move(moved);
  }

  void match(const TriangleMesh& mesh) {
    VertexMatchOptions how;
    how.measure = options_.measure;
    how.radius = searches_++ == 0 ? options_.radius : options_.laterRadius;
    how.leastTexture = options_.leastTexture;
    how.threads = options_.threads;
    const MakeTemplateSearch search = options_.search ? options_.search : processorTemplateSearch;
    matches_ = timed("matching", [&] {
      return matchVertices(mesh, views_, members_, complements_, how, search, progress_);
    });
    solve(mesh);
  }

  void solve(const TriangleMesh& mesh) {
    complements_ = timed("complements", [&] {
      return complementsOf(mesh, views_.size(), members_, matches_,
                           {options_.smoothness, options_.outlierPx, options_.threads});
    });
  }

  double measured() const {
    std::size_t pairs = 0, known = 0;
    for (const CameraSet set : members_) pairs += std::size_t(std::popcount(set)) * std::size_t(std::popcount(set) - (set != 0));
    for (const VertexMatch& match : matches_) known += match.information.x + match.information.z > 0;
    return pairs > 0 ? double(known) / double(pairs) : 0;
  }

  // Alg. 6.
  std::vector<std::uint8_t> facesToDivide(const TriangleMesh& mesh, const Looked& now,
                                          std::span<const double> difference, HtmReport::Round& line) const {
    std::vector<std::uint8_t> divide(mesh.triangles.size(), 0);
    const bool apart = line.after > options_.meanDifference;
    for (std::size_t f = 0; f < divide.size(); ++f) {
      const bool different = apart && difference[f] > options_.faceDifference;
      const bool hidden = options_.selfOccluded && now.faces[f].partly != 0;
      if (!(different || hidden) || !largeEnough(mesh, now, f)) continue;
      divide[f] = 1;
      ++line.divided;
      line.divideHidden += !different;
    }
    return divide;
  }

  bool largeEnough(const TriangleMesh& mesh, const Looked& now, std::size_t face) const {
    for (std::size_t i = 0; i < now.views.size(); ++i) {
      if (!(now.faces[face].seen >> i & 1)) continue;
      const PinholeView& view = now.views[i].view;
      const auto a = view.seen(mesh.positions[mesh.triangles[face].x]), b = view.seen(mesh.positions[mesh.triangles[face].y]),
                 c = view.seen(mesh.positions[mesh.triangles[face].z]);
      if (!a || !b || !c) continue;
      const glm::dvec2 ab = b->pixel - a->pixel, ac = c->pixel - a->pixel;
      if (0.5 * std::abs(ab.x * ac.y - ab.y * ac.x) >= options_.leastFacePx) return true;
    }
    return false;
  }

  void finish(TriangleMesh& mesh) {
    const Looked last = timed("visibility", [&] { return looked(mesh); });
    HtmReport& report = result_.report;
    std::size_t seen = 0, left = 0;
    for (const CameraSet set : members_) seen += std::size_t(std::popcount(set));
    if (options_.reject) {
      timed("rejection", [&] {
        RejectOptions how;
        how.mostDifference = options_.rejectDifference;
        how.leastCorrelation = options_.rejectCorrelation;
        const std::vector<Agreement> known =
            agreements(mesh, last.views, members_, complements_, how.segment, options_.threads);
        members_ = agreeingMembers(views_.size(), members_, known, facing(mesh, last), how);
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

  // How much each camera looks at each vertex from its front, 0 to 1; n_c × n_v.
  static std::vector<float> facing(const TriangleMesh& mesh, const Looked& looked) {
    const std::vector<glm::dvec3> normal = vertexNormals(mesh);
    std::vector<float> facing;
    for (const ProjectedMesh& view : looked.views)
      for (std::size_t v = 0; v < normal.size(); ++v) {
        const glm::dvec3 towards = view.view.centre() - mesh.positions[v];
        const double lengths = glm::length(normal[v]) * glm::length(towards);
        facing.push_back(lengths > 0 ? float(std::max(0.0, glm::dot(normal[v], towards) / lengths)) : 0.0f);
      }
    return facing;
  }

  const HtmOptions& options_;
  const ProgressCallback& progress_;
  BuildJobs jobs_;
  std::vector<HtmView> views_;
  int searches_ = 0;  // so far
  std::vector<CameraSet> members_;
  std::vector<VertexMatch> matches_;
  std::vector<glm::vec2> complements_;  // also the start of the next round's
  HtmResult result_;
};

void checkMesh(const TriangleMesh& mesh) {
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    for (int c = 0; c < 3; ++c)
      check(std::isfinite(mesh.positions[v][c]), ErrorCode::invalidInput, "harmonise: vertex {} of the mesh is not finite",
            v);
  for (std::size_t f = 0; f < mesh.triangles.size(); ++f)
    for (int k = 0; k < 3; ++k)
      check(mesh.triangles[f][k] < mesh.positions.size(), ErrorCode::invalidInput,
            "harmonise: face {} of the mesh has vertex {} of {}", f, mesh.triangles[f][k], mesh.positions.size());
}

void checkPhotographs(std::span<const HtmPhotograph> photographs) {
  check(!photographs.empty() && photographs.size() <= kLargestHtmCameraCount, ErrorCode::invalidInput,
        "harmonise: {} cameras, not 1 to {}", photographs.size(), kLargestHtmCameraCount);
  for (const HtmPhotograph& p : photographs) {
    const Intrinsics& k = p.camera.camera.intrinsics;
    check(k.model == CameraModel::pinhole, ErrorCode::invalidInput, "{}: is no pinhole", p.camera.name);
    check(std::max(k.width, k.height) <= std::numeric_limits<std::int16_t>::max(), ErrorCode::invalidInput,
          "{}: {} × {} px, more than templates count", p.camera.name, k.width, k.height);  // TemplateSample
    check(p.picture.channels == 3 && p.picture.width == k.width && p.picture.height == k.height,
          ErrorCode::invalidInput, "{}: the picture is {} × {}, its camera {} × {}", p.camera.name, p.picture.width,
          p.picture.height, k.width, k.height);
    check(p.mask.empty() || (p.mask.channels == 1 && p.mask.width == k.width && p.mask.height == k.height),
          ErrorCode::invalidInput, "{}: the mask is {} × {}, its camera {} × {}", p.camera.name, p.mask.width,
          p.mask.height, k.width, k.height);
  }
}

}  // namespace

HtmResult harmonise(const TriangleMesh& mesh, std::span<const HtmPhotograph> photographs, const HtmOptions& options,
                    const ProgressCallback& progress, const LogCallback&) {
  checkOptions(options);
  checkMesh(mesh);
  checkPhotographs(photographs);
  return Harmoniser(photographs, options, progress).run(mesh, photographs);
}

}  // namespace ibr
