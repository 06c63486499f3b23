// SPDX-License-Identifier: Apache-2.0
#include "author/graph/view_relations.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <iterator>
#include <map>
#include <numbers>

#include "author/geometry/posed_model.h"

namespace ibr {
namespace {

// Angle of one image width near the axis.
double widthInRadians(const Intrinsics& k) {
  return k.model == CameraModel::equirectangular ? 2 * std::numbers::pi : k.width / k.fx;
}

double quantile(std::vector<double>& values, double share) {
  const auto at = values.begin() + std::ptrdiff_t(std::lround(share * double(values.size() - 1)));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

double angleBetween(glm::dvec3 a, glm::dvec3 b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

ViewRelations::ViewRelations(const PosedModel& model) : model_(model), tracks_(tracksOfImages(model)) {}

const ViewRelation& ViewRelations::between(std::uint32_t a, std::uint32_t b) const {
  const std::uint64_t key = (std::uint64_t(std::min(a, b)) << 32) | std::max(a, b);
  const auto found = known_.find(key);
  return found != known_.end() ? found->second
                               : known_.emplace(key, find(std::min(a, b), std::max(a, b))).first->second;
}

// A point's disparity is the angle at the point between its rays, in image widths: for rays near the axes, the point's
// movement between the two images if both had the same rotation.
ViewRelation ViewRelations::find(std::uint32_t a, std::uint32_t b) const {
  const Camera &first = model_.images[a].camera, &second = model_.images[b].camera;
  ViewRelation relation;
  relation.axisAngle = angleBetween(viewAxis(first.pose), viewAxis(second.pose));
  relation.fewerTracks = std::uint32_t(std::min(tracks_[a].size(), tracks_[b].size()));
  std::vector<std::uint32_t> common;
  std::set_intersection(tracks_[a].begin(), tracks_[a].end(), tracks_[b].begin(), tracks_[b].end(),
                        std::back_inserter(common));
  relation.shared = std::uint32_t(common.size());
  if (common.empty()) return relation;
  const double width = 0.5 * (widthInRadians(first.intrinsics) + widthInRadians(second.intrinsics));
  std::vector<double> disparities;
  disparities.reserve(common.size());
  for (const std::uint32_t t : common) {
    const glm::dvec3 point = model_.tracks[t].position;
    disparities.push_back(angleBetween(point - first.pose.position, point - second.pose.position) / width);
  }
  const double high = quantile(disparities, 0.9);
  relation.disparitySpread = high - quantile(disparities, 0.1);
  return relation;
}

std::vector<std::pair<std::uint32_t, std::uint32_t>> ViewRelations::neighbours(std::uint32_t image,
                                                                               std::uint32_t least) const {
  std::map<std::uint32_t, std::uint32_t> shared;
  for (const std::uint32_t t : tracks_[image]) {
    std::vector<std::uint32_t> others;  // without duplicates: an image may observe a point twice
    for (const TrackObservation& seen : model_.tracks[t].observations)
      if (seen.image != image) others.push_back(seen.image);
    std::sort(others.begin(), others.end());
    others.erase(std::unique(others.begin(), others.end()), others.end());
    for (const std::uint32_t other : others) ++shared[other];
  }
  std::vector<std::pair<std::uint32_t, std::uint32_t>> result;
  for (const auto& entry : shared)
    if (entry.second >= least) result.push_back(entry);
  return result;
}

}  // namespace ibr
