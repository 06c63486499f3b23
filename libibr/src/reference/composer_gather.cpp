// SPDX-License-Identifier: Apache-2.0
#include "reference/composer_gather.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <optional>

#include "reference/composer_vote.h"

namespace ibr::reference {
namespace {

// Constants are fixed, because results for different depth maps are compared.
constexpr double kAngleFloor = 0.03;        // radians, added to every angle
constexpr double kDistanceCost = 0.001;     // radians per spacing
constexpr double kMaxResolution = 1.5;      // of the view's: a finer photograph is no better
constexpr double kVisibilityFloor = 0.002;  // a hidden photograph is better than none
constexpr double kBehindVisibility = 0.25;  // if the photograph's own surface is behind the point
constexpr double kOwnPoseCost = 0.01;       // radians of cost within which visibility and borders fade to no effect
constexpr double kMinApart = 1e-6;          // limits the weight at a photograph's own pose
constexpr double kOcclusionSigmas = 3;      // deviations of both surfaces within which nothing counts as hidden
constexpr double kLevels = 255;

// Weight and sampling of a surface in one photograph.
struct Sight {
  double weight = 0;
  double footprint = 1;  // texels per pixel
  glm::dvec2 pixel{0};
  const PhotographSampler* sampler = nullptr;
};

std::optional<Sight> sightOf(const PhotographSampler& sampler, glm::dvec2 viewPixel, double inverseDepth,
                             double uncertainty, double detail) {
  const Candidate& candidate = sampler.candidate();
  const glm::dvec3 ray = sampler.ray(viewPixel), direction = ray + inverseDepth * sampler.shift();
  const std::optional<glm::dvec2> pixel = sampler.pixel(direction);
  if (!pixel) return std::nullopt;
  // By the cross product of ray and direction, which avoids the difference of nearly parallel vectors.
  const double angle =
      std::atan2(inverseDepth * glm::length(glm::cross(ray, sampler.shift())), glm::dot(ray, direction));
  const double beyond = angle + kDistanceCost * candidate.distance, cost = kAngleFloor + beyond;
  const double finer = sampler.resolution(ray, direction), resolution = std::min(finer, kMaxResolution);
  const double here = sampler.inverseDepth(direction, inverseDepth), own = sampler.ownInverseDepth(*pixel);
  const double unsure = uncertainty * here + uncertaintyOf(sampler.ownConsensus(*pixel)) * own;
  const double tolerance = 2 * toleranceOf(candidate.step, here) + candidate.residual + kOcclusionSigmas * unsure;
  const double before = std::clamp((own - here) / tolerance - 1, 0.0, 1.0),
               behind = std::clamp((here - own) / tolerance - 1, 0.0, 1.0);
  const double visible = std::max((1 - before) * (1 - (1 - kBehindVisibility) * behind), kVisibilityFloor);
  const double apart = glm::smoothstep(0.0, kOwnPoseCost, beyond);
  Sight sight{candidate.weight * resolution * resolution * glm::mix(1.0, sampler.border(*pixel), apart) *
                  glm::mix(1.0, visible, apart) / (cost * std::max(apart, kMinApart)),
              std::max(detail * finer, uncertainty * angle * focalPx(candidate.camera.intrinsics)), *pixel, &sampler};
  if (candidate.masked && sight.weight > 0)  // shared/cell.h, maskShare
    sight.weight *= std::clamp(2 * sampler.colour(*pixel, sight.footprint).alpha - 1, 0.0, 1.0);
  return sight;
}

}  // namespace

Gather::Gather(const Camera& view, std::span<const Candidate> candidates, std::size_t colours, double detail)
    : colours_(colours), detail_(detail) {
  for (const Candidate& candidate : candidates) samplers_.emplace_back(view, candidate);
}

Gathered Gather::at(glm::dvec2 pixel, double inverseDepth, double uncertainty) const {
  std::vector<Sight> sights;
  for (const PhotographSampler& sampler : samplers_)
    if (const auto sight = sightOf(sampler, pixel, inverseDepth, uncertainty, detail_); sight && sight->weight > 0)
      sights.push_back(*sight);
  std::ranges::stable_sort(sights, [](const Sight& a, const Sight& b) { return a.weight > b.weight; });
  const double next = sights.size() > colours_ ? sights[colours_].weight : 0.0;
  Gathered result;
  double sum = 0;
  glm::dvec3 square(0);
  for (std::size_t k = 0; k < std::min(sights.size(), colours_); ++k) {
    const double weight = sights[k].weight - next;
    if (!(weight > 0)) continue;
    const glm::dvec3 colour = sights[k].sampler->colour(sights[k].pixel, sights[k].footprint).colour;
    sum += weight;
    result.colour += weight * colour;
    square += weight * colour * colour;
  }
  if (!(sum > 0)) return result;
  result.known = true;
  result.colour /= sum;
  const glm::dvec3 variance = glm::max(square / sum - result.colour * result.colour, 0.0);
  result.variance = kLevels * kLevels * (variance.x + variance.y + variance.z) / 3;
  return result;
}

}  // namespace ibr::reference
