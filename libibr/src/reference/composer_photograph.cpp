// SPDX-License-Identifier: Apache-2.0
#include "reference/composer_photograph.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numbers>

namespace ibr::reference {
namespace {

constexpr double kBorderShare = 0.04;  // of the width, over which a photograph fades at its border

// Bilinear sample of a channel at (x, y), px of the map; `around`: x wraps, for panoramas.
double bilinear(const ImageF& map, std::size_t channel, double x, double y, bool around) {
  x -= 0.5;
  y -= 0.5;
  const int left = int(std::floor(x)), top = int(std::floor(y));
  double sum = 0;
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      const int column =
          around ? ((left + i) % map.width + map.width) % map.width : std::clamp(left + i, 0, map.width - 1);
      const double value = double(map.pixel(column, std::clamp(top + j, 0, map.height - 1))[channel]);
      sum += (i ? x - left : 1 - (x - left)) * (j ? y - top : 1 - (y - top)) * value;
    }
  return sum;
}

glm::dvec2 share(const Intrinsics& k, glm::dvec2 pixel) {
  return pixel / glm::dvec2(k.width, k.height);
}

}  // namespace

double focalPx(const Intrinsics& k) {
  return k.model == CameraModel::equirectangular ? k.width / (2 * std::numbers::pi) : k.fx;
}

PhotographSampler::PhotographSampler(const Camera& view, const Candidate& candidate)
    : candidate_(&candidate), view_(view.intrinsics) {
  const glm::dquat toPhotograph = glm::conjugate(candidate.camera.pose.rotation);
  turn_ = glm::mat3_cast(toPhotograph * view.pose.rotation);
  shift_ = toPhotograph * (view.pose.position - candidate.camera.pose.position);
}

glm::dvec3 PhotographSampler::ray(glm::dvec2 pixel) const {
  return turn_ * glm::dvec3((pixel.x - view_.cx) / view_.fx, (view_.cy - pixel.y) / view_.fy, -1.0);
}

std::optional<glm::dvec2> PhotographSampler::pixel(const glm::dvec3& direction) const {
  const Intrinsics& k = candidate_->camera.intrinsics;
  const std::optional<glm::dvec2> at = project(k, direction);
  if (!at || isPanorama()) return at;
  const bool inside = at->x >= 0 && at->y >= 0 && at->x <= k.width && at->y <= k.height;
  return inside ? at : std::nullopt;
}

double PhotographSampler::inverseDepth(const glm::dvec3& direction, double viewInverseDepth) const {
  return viewInverseDepth / (isPanorama() ? glm::length(direction) : -direction.z);
}

double PhotographSampler::ownInverseDepth(glm::dvec2 pixel) const {
  const ImageF& map = *candidate_->depth;
  const glm::dvec2 at = share(candidate_->camera.intrinsics, pixel) * glm::dvec2(map.width, map.height);
  return candidate_->depthScale * bilinear(map, 0, at.x, at.y, isPanorama());
}

double PhotographSampler::ownConsensus(glm::dvec2 pixel) const {
  const ImageF& map = *candidate_->depth;
  if (map.channels < 2) return 1;
  const glm::dvec2 at = share(candidate_->camera.intrinsics, pixel) * glm::dvec2(map.width, map.height);
  return bilinear(map, 1, at.x, at.y, isPanorama());
}

double PhotographSampler::border(glm::dvec2 pixel) const {
  if (isPanorama()) return 1;
  const Intrinsics& k = candidate_->camera.intrinsics;
  const double inside = std::min(std::min(pixel.x, k.width - pixel.x), std::min(pixel.y, k.height - pixel.y));
  return std::clamp(inside / (kBorderShare * k.width), 0.0, 1.0);
}

double PhotographSampler::resolution(const glm::dvec3& ray, const glm::dvec3& direction) const {
  return focalPx(candidate_->camera.intrinsics) * glm::length(ray) / (view_.fx * glm::length(direction));
}

Texel PhotographSampler::colour(glm::dvec2 pixel, double footprint) const {
  Texel texel = trilinear(*candidate_->levels, share(candidate_->camera.intrinsics, pixel), footprint, isPanorama(),
                          candidate_->cubic);
  if (candidate_->gain != glm::dvec3(1)) texel.colour = exposedColour(texel.colour, candidate_->gain);
  return texel;
}

}  // namespace ibr::reference
