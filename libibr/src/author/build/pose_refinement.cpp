// SPDX-License-Identifier: Apache-2.0
#include "author/build/pose_refinement.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <span>

#include "author/build/dense_tracks.h"
#include "author/geometry/posed_model.h"
#include "author/poses/bundle_adjust.h"
#include "author/poses/cross_validation.h"
#include "ibr/author/poses.h"

namespace ibr {
namespace {

constexpr double kRotationDeviation = 0.01,
                 kPositionDeviation = 0.02;  // standard deviations of the priors: rad; median edges of cells
constexpr double kFocalDeviation = 0.05,
                 kCentreDeviationPx = 2.0;  // standard deviations: relative focal length; principal point, px
constexpr double kCauchyPx = 0.15;  // scale of good matches' errors; a dense matcher's outliers are large and one-sided
constexpr double kMinStandardErrors = 3;  // standard errors by which a step must improve the fit

struct Problem {
  std::vector<BundleCamera> cameras;  // at the matched size
  std::vector<BundlePoint> points;    // of the cells first, then of the model
  std::size_t ofCells = 0;
};

bool isPinhole(const Photograph& photograph) {
  return photograph.camera.intrinsics.model == CameraModel::pinhole;
}

// Scale in x and y, which differ because sizes are rounded.
glm::dvec2 scaleTo(const Intrinsics& to, const Intrinsics& from) {
  return {double(to.width) / from.width, double(to.height) / from.height};
}

std::vector<BundleCamera> bundleCameras(const BuildInput& input) {
  std::vector<BundleCamera> cameras;
  std::vector<const PosedImage*> known;
  for (std::size_t i = 0; i < input.photographs.size(); ++i) {
    const PosedImage& image = input.model.images[i];
    const auto same = std::ranges::find_if(known, [&](const PosedImage* other) {
      return other->camera.intrinsics == image.camera.intrinsics && other->lens == image.lens;
    });
    BundleCamera camera{matchedCamera(input.photographs[i].camera)};
    camera.intrinsics = std::uint32_t(same - known.begin());
    camera.keepIntrinsics = image.lens.has_value();
    if (same == known.end()) known.push_back(&image);
    cameras.push_back(camera);
  }
  return cameras;
}

Problem problemOf(const BuildInput& input, const std::vector<Cell>& cells) {
  Problem problem{bundleCameras(input), {}, 0};
  std::vector<Node> nodes(input.photographs.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) nodes[i].camera = input.photographs[i].camera;
  problem.points = denseTracks(nodes, cells);
  problem.ofCells = problem.points.size();
  for (BundlePoint& point : problem.points)
    for (BundleObservation& seen : point.seen)
      seen.pixel *= scaleTo(problem.cameras[seen.camera].camera.intrinsics, nodes[seen.camera].camera.intrinsics);
  for (const Track& track : input.model.tracks) {
    BundlePoint point{glm::dvec4(track.position, 1), {}};
    for (const TrackObservation& seen : track.observations)
      if (isPinhole(input.photographs[seen.image]))
        point.seen.push_back({seen.image, seen.pixel * scaleTo(problem.cameras[seen.image].camera.intrinsics,
                                                               input.model.images[seen.image].camera.intrinsics)});
    problem.points.push_back(std::move(point));
  }
  return problem;
}

// Median and 90 % quantile.
PoseRefinement::Errors errorsOf(const Problem& problem, const Bundle& bundle) {
  std::vector<double> errors;
  for (std::size_t p = 0; p < bundle.points.size(); ++p)
    if (problem.points[p].seen.size() > 1)
      for (const auto& [camera, pixel] : problem.points[p].seen)
        if (const auto at = seenAt(bundle.cameras[camera], bundle.points[p]))
          errors.push_back(glm::distance(*at, pixel));
  if (errors.empty()) return {};
  const auto most = errors.begin() + std::ptrdiff_t(0.9 * double(errors.size()));
  std::nth_element(errors.begin(), most, errors.end());
  const double p90 = *most;
  return {median(errors), p90};
}

// Data that cameras are fitted to, and whether intrinsics are fitted.
struct Fit {
  bool cells = false, intrinsics = false;
};

// Successive fits with more data or parameters; a fit is accepted only if held-out points fit better
// (cross_validation.h).
class Fits {
 public:
  Fits(const Problem& problem, const std::vector<std::size_t>& used, double edge) : problem_(problem) {
    options_.cauchyPx = kCauchyPx;
    options_.radians = kRotationDeviation;
    options_.shift = kPositionDeviation * edge;
    std::vector<Camera> cameras;
    for (const std::size_t i : used) cameras.push_back(problem.cameras[i].camera);
    patches_ = patchesOf(cameras, problem.points);
  }

  std::vector<BundleCamera> fitted(const Fit& fit, int half = kBoth) const {
    std::vector<BundlePoint> points;
    for (std::size_t p = fit.cells ? 0 : problem_.ofCells; p < problem_.points.size(); ++p)
      if (half == kBoth || halfOf(p) == half) points.push_back(problem_.points[p]);
    BundleOptions options = options_;
    if (fit.intrinsics) {
      options.focal = kFocalDeviation;
      options.centrePx = kCentreDeviationPx;
    }
    const Bundle bundle = adjustBundle(problem_.cameras, points, options);
    std::vector<BundleCamera> cameras = problem_.cameras;
    for (std::size_t i = 0; i < cameras.size(); ++i) cameras[i].camera = bundle.cameras[i];
    return cameras;
  }

  // Returns nullopt if no fit is better than the given cameras.
  std::optional<Fit> best(std::vector<PoseRefinement::Step>& steps) const {
    std::optional<Fit> best;
    std::vector<double> costs = costsOf(problem_.cameras, problem_.points, kCauchyPx);
    const auto attempt = [&](const char* by, const Fit& fit) {
      const std::vector<double> now = heldOutCosts(fit);
      PoseRefinement::Step step{by, improvement(costs, now, true), improvement(costs, now, false)};
      const bool measured = !std::isnan(step.cellsGainSigmas) || !std::isnan(step.modelGainSigmas);
      step.accepted =
          measured && !(step.cellsGainSigmas < kMinStandardErrors) && !(step.modelGainSigmas < kMinStandardErrors);
      steps.push_back(step);
      if (!step.accepted) return;
      best = fit;
      costs = now;
    };
    if (problem_.points.size() > problem_.ofCells) attempt("points of the model", {false, false});
    if (problem_.ofCells > 0) attempt("points of cells", {true, false});
    attempt("intrinsics", {best ? best->cells : true, true});
    return best;
  }

 private:
  static constexpr int kBoth = -1;

  int halfOf(std::size_t point) const { return int(patches_[point] % 2); }

  // Costs of all points, each by the cameras fitted to the half that does not contain the point.
  std::vector<double> heldOutCosts(const Fit& fit) const {
    std::vector<double> costs(problem_.points.size());
    for (const int half : {0, 1}) {
      std::vector<BundlePoint> points = problem_.points;
      for (std::size_t p = 0; p < points.size(); ++p)
        if (halfOf(p) != half) points[p].seen.clear();
      const std::vector<double> ofHalf = costsOf(fitted(fit, 1 - half), points, kCauchyPx);
      for (std::size_t p = 0; p < points.size(); ++p) costs[p] += ofHalf[p];
    }
    return costs;
  }

  double improvement(const std::vector<double>& before, const std::vector<double>& after, bool cells) const {
    const std::size_t first = cells ? 0 : problem_.ofCells;
    const std::size_t count = cells ? problem_.ofCells : before.size() - first;
    return significance(std::span(before).subspan(first, count), std::span(after).subspan(first, count),
                        std::span(patches_).subspan(first, count));
  }

  const Problem& problem_;
  BundleOptions options_;
  std::vector<std::uint32_t> patches_;
};

// Pinholes that see a point which another camera sees too.
std::vector<std::size_t> connectedCameras(const Problem& problem, const BuildInput& input) {
  std::vector<bool> sees(problem.cameras.size(), false);
  for (const BundlePoint& point : problem.points)
    if (point.seen.size() > 1)
      for (const BundleObservation& seen : point.seen) sees[seen.camera] = true;
  std::vector<std::size_t> cameras;
  for (std::size_t i = 0; i < sees.size(); ++i)
    if (sees[i] && isPinhole(input.photographs[i])) cameras.push_back(i);
  return cameras;
}

double medianEdge(const BuildInput& input, const std::vector<Cell>& cells) {
  std::vector<double> edges;
  for (const Cell& cell : cells)
    for (std::size_t i = 1; i < cell.members.size(); ++i)
      edges.push_back(glm::distance(input.photographs[cell.members[i]].camera.pose.position,
                                    input.photographs[cell.members[0]].camera.pose.position));
  return edges.empty() ? 0 : median(edges);
}

// Applies the change from `was` to `matched` to a camera.
void setCamera(Camera& camera, const Camera& was, const Camera& matched) {
  Intrinsics& k = camera.intrinsics;
  const glm::dvec2 scale = scaleTo(k, was.intrinsics);
  k.fx *= matched.intrinsics.fx / was.intrinsics.fx;
  k.fy *= matched.intrinsics.fy / was.intrinsics.fy;
  k.cx += scale.x * (matched.intrinsics.cx - was.intrinsics.cx);
  k.cy += scale.y * (matched.intrinsics.cy - was.intrinsics.cy);
  camera.pose = matched.pose;
}

}  // namespace

PoseRefinement refinePoses(BuildInput& input, const std::vector<Cell>& cells) {
  const Problem problem = problemOf(input, cells);
  PoseRefinement report;
  report.cellTracks = problem.ofCells;
  report.modelTracks = input.model.tracks.size();
  const double edge = medianEdge(input, cells);
  const std::vector<std::size_t> used = connectedCameras(problem, input);
  if (!(edge > 0) || used.empty()) return report;
  const Fits fits(problem, used, edge);
  const std::optional<Fit> best = fits.best(report.steps);
  const auto placed = [&](std::span<const BundleCamera> cameras) {
    return adjustBundle(withFixedCameras(cameras), problem.points, {.cauchyPx = kCauchyPx});
  };
  report.initialErrors = report.finalErrors = errorsOf(problem, placed(problem.cameras));
  if (!best) return report;
  Bundle after = placed(fits.fitted(*best));
  report.finalErrors = errorsOf(problem, after);

  std::vector<Pose> from, to;
  for (const std::size_t i : used) {
    from.push_back(after.cameras[i].pose);
    to.push_back(problem.cameras[i].camera.pose);
  }
  const SimilarityTransform back = estimateSimilarity(from, to);
  for (const std::size_t i : used) {
    Camera& camera = after.cameras[i];
    camera.pose = back(camera.pose);
    const Camera& was = problem.cameras[i].camera;
    report.poseChanges.push_back(
        {input.photographs[i].name, angleBetween(camera.pose.rotation, was.pose.rotation) * was.intrinsics.fx,
         glm::distance(camera.pose.position, was.pose.position), camera.intrinsics.fx / was.intrinsics.fx});
    setCamera(input.photographs[i].camera, was, camera);
    setCamera(input.model.images[i].camera, was, camera);
  }
  for (std::size_t t = 0; t < input.model.tracks.size(); ++t) {
    const glm::dvec4& point = after.points[problem.ofCells + t];
    const glm::dvec3 position = back(glm::dvec3(point) / point.w);
    if (std::isfinite(position.x + position.y + position.z)) input.model.tracks[t].position = position;
  }
  return report;
}

}  // namespace ibr
