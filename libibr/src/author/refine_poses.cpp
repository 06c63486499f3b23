// SPDX-License-Identifier: Apache-2.0
#include "author/refine_poses.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "author/bundle_adjust.h"
#include "author/dense_tracks.h"
#include "author/posed_model.h"
#include "author/similarity.h"

namespace ibr {
namespace {

constexpr double kRadians = 0.01, kShift = 0.02;  // one standard deviation of the priors; of the median edge of cells
constexpr double kFocal = 0.05, kCentrePx = 2.0;

struct Problem {
  std::vector<BundleCamera> cameras;  // at the size that is matched
  std::vector<BundlePoint> points;    // of cells first, then of the model
  std::size_t ofCells = 0;
};

bool isPinhole(const Photograph& photograph) {
  return photograph.camera.intrinsics.model == CameraModel::pinhole;
}

// Of pixels: across and down, as sizes are rounded.
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

// Median and nine tenths.
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

double medianEdge(const BuildInput& input, const std::vector<Cell>& cells) {
  std::vector<double> edges;
  for (const Cell& cell : cells)
    for (std::size_t i = 1; i < cell.members.size(); ++i)
      edges.push_back(glm::distance(input.photographs[cell.members[i]].camera.pose.position,
                                    input.photographs[cell.members[0]].camera.pose.position));
  return edges.empty() ? 0 : median(edges);
}

// What `matched` changed from `was`.
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
  PoseRefinement report{problem.ofCells, input.model.tracks.size(), {}, {}, {}};
  const double edge = medianEdge(input, cells);
  if (!(edge > 0)) return report;
  std::vector<std::size_t> used;
  std::vector<bool> sees(problem.cameras.size(), false);
  for (const BundlePoint& point : problem.points)
    if (point.seen.size() > 1)
      for (const BundleObservation& seen : point.seen) sees[seen.camera] = true;
  for (std::size_t i = 0; i < sees.size(); ++i)
    if (sees[i] && isPinhole(input.photographs[i])) used.push_back(i);

  std::vector<BundleCamera> still = problem.cameras;
  for (BundleCamera& camera : still) camera.fixed = true;
  const Bundle before = adjustBundle(still, problem.points);
  BundleOptions options;
  options.radians = kRadians;
  options.shift = kShift * edge;
  options.focal = kFocal;
  options.centrePx = kCentrePx;
  Bundle after = adjustBundle(problem.cameras, problem.points, options);
  report.before = errorsOf(problem, before);
  report.after = errorsOf(problem, after);

  std::vector<Pose> from, to;
  for (const std::size_t i : used) {
    from.push_back(after.cameras[i].pose);
    to.push_back(problem.cameras[i].camera.pose);
  }
  const Similarity back = aligned(from, to);
  for (const std::size_t i : used) {
    Camera& camera = after.cameras[i];
    camera.pose = back(camera.pose);
    const Camera& was = problem.cameras[i].camera;
    report.moved.push_back(
        {input.photographs[i].name, angleBetween(camera.pose.rotation, was.pose.rotation) * was.intrinsics.fx,
         glm::distance(camera.pose.position, was.pose.position), camera.intrinsics.fx / was.intrinsics.fx});
    setCamera(input.photographs[i].camera, was, camera);
    setCamera(input.model.images[i].camera, was, camera);
  }
  for (std::size_t t = 0; t < input.model.tracks.size(); ++t) {
    const glm::dvec4& point = after.points[problem.ofCells + t];
    const glm::dvec3 place = back(glm::dvec3(point) / point.w);
    if (std::isfinite(place.x + place.y + place.z)) input.model.tracks[t].position = place;
  }
  return report;
}

}  // namespace ibr
