// SPDX-License-Identifier: Apache-2.0
#include "author/build/sweep_plan.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/gtc/quaternion.hpp>
#include <iterator>
#include <utility>

#include "author/backdrop/backdrop.h"
#include "author/build/assumed_tracks.h"
#include "author/depth/depth_sources.h"
#include "author/geometry/mean_frame.h"
#include "author/geometry/posed_model.h"

namespace ibr {
namespace {

// Returns 0 if the camera does not see the point.
double inverseDepthSeen(const Camera& camera, const glm::dvec3& point) {
  const Intrinsics& k = camera.intrinsics;
  const auto at = project(k, glm::conjugate(camera.pose.rotation) * (point - camera.pose.position));
  const bool inside = at && at->x >= 0 && at->y >= 0 && at->x <= k.width && at->y <= k.height;
  return inside ? inverseDepth(camera, point) : 0;
}

}  // namespace

glm::ivec2 sweptSize(const Intrinsics& stored) {
  const Intrinsics matched = matchedCamera({stored, {}}).intrinsics;
  return glm::max(glm::ivec2(1), glm::min(glm::ivec2(matched.width / 2, matched.height / 2), backdropSize(stored)));
}

SweepPlan::SweepPlan(const BuildInput& input) : model_(input.model) {
  std::vector<bool> hasNone;
  for (const auto& tracks : input.tracksOf) hasNone.push_back(tracks.empty());
  std::vector<Camera> cameras;
  for (const Photograph& photo : input.photographs) cameras.push_back(photo.camera);
  std::ranges::move(assumedTracks(cameras, hasNone), std::back_inserter(model_.tracks));
  tracksOf_ = tracksOfImages(model_);
  views_ = depthViews(cameras);
  std::vector<std::vector<double>> tracks;
  for (std::size_t v = 0; v < views_.size(); ++v) tracks.push_back(tracksSeenBy(v));
  fromInfinity_ = mostReachInfinity(std::move(tracks));
}

std::vector<double> SweepPlan::tracksSeenBy(std::size_t view) const {
  std::vector<double> tracks;
  for (const std::uint32_t t : tracksOf_[views_[view].node])
    if (const double w = inverseDepthSeen(views_[view].camera, model_.tracks[t].position); w > 0 && std::isfinite(w))
      tracks.push_back(w);
  return tracks;
}

std::optional<ViewSweep> SweepPlan::sweep(std::size_t view) const {
  std::vector<double> tracks = tracksSeenBy(view);
  std::vector<std::uint32_t> sources = depthSources(model_, views_, tracksOf_, std::uint32_t(view));
  if (sources.empty() || tracks.empty()) return std::nullopt;
  return ViewSweep{std::move(sources), sweepRange(std::move(tracks), fromInfinity_)};
}

int SweepPlan::levels(std::size_t view) const {
  const std::optional<ViewSweep> swept = sweep(view);
  if (!swept) return 0;
  const auto sized = [](const Camera& stored) {
    const glm::ivec2 size = sweptSize(stored.intrinsics);
    return Camera{resized(stored.intrinsics, size.x, size.y), stored.pose};
  };
  std::vector<Camera> sources;
  for (const std::uint32_t j : swept->sources) sources.push_back(sized(views_[j].camera));
  return sweepLevelCount(sized(views_[view].camera), sources, swept->range);
}

}  // namespace ibr
