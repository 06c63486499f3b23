// SPDX-License-Identifier: Apache-2.0
#include "render/plan/photograph_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <numeric>

#include "base/median.h"
#include "scene/capture_spacing.h"
#include "shared/gather.h"

namespace ibr {
namespace {

constexpr int kColumns = 16, kRows = 9;
constexpr std::array kDepths{1.6, 0.4};  // of the median ρ
constexpr std::size_t kSamplePoints = std::size_t(kColumns) * kRows * kDepths.size();
constexpr std::size_t kMaxPoolSize = 64;  // photographs, best by themselves, that take part in exchanges
// A member whose loss exceeds the best outsider's gain by this share has weight 1.
constexpr double kFadeShare = 0.25;
constexpr double kMinRelativeGain = 1e-9;  // relative gain of F below which no exchange is made

using Values = std::array<float, kSamplePoints>;  // of a photograph, by ray and depth

struct Candidate {
  std::uint32_t backdrop = 0;
  double distance = 0;
  float alone = 0;
  Values value;
};

// Returns rays over all views, in the axes of the middle pose.
std::vector<glm::dvec3> raysOf(const std::vector<Camera>& views, const Pose& middle) {
  glm::dvec2 low(std::numeric_limits<double>::infinity()), high(-low);
  for (const Camera& view : views) {
    const glm::dquat turn = glm::conjugate(middle.rotation) * view.pose.rotation;
    const Intrinsics& k = view.intrinsics;
    for (const double x : {0.0, double(k.width)})
      for (const double y : {0.0, double(k.height)}) {
        const glm::dvec3 ray = turn * glm::dvec3((x - k.cx) / k.fx, (k.cy - y) / k.fy, -1.0);
        const double depth = std::max(-ray.z, 0.1);  // lower bound for views that look in different directions
        low = glm::min(low, glm::dvec2(ray) / depth);
        high = glm::max(high, glm::dvec2(ray) / depth);
      }
  }
  std::vector<glm::dvec3> rays;
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column)
      rays.emplace_back(glm::mix(low, high, glm::dvec2((column + 0.5) / kColumns, (row + 0.5) / kRows)), -1.0);
  return rays;
}

Values valuesOf(const Camera& photograph, const Pose& middle, const std::vector<glm::dvec3>& rays,
                double medianInverseDepth) {
  const Intrinsics& k = photograph.intrinsics;
  const glm::dquat toPhotograph = glm::conjugate(photograph.pose.rotation);
  const glm::dmat3 turn = glm::mat3_cast(toPhotograph * middle.rotation);
  const glm::dvec3 shift = toPhotograph * (middle.position - photograph.pose.position);
  Values values{};
  std::size_t point = 0;
  for (const double depth : kDepths)
    for (const glm::dvec3& ray : rays) {
      float& value = values[point++];
      const glm::dvec3 turned = turn * ray, direction = turned + depth * medianInverseDepth * shift;
      double border = 1;
      if (k.model == CameraModel::pinhole) {
        const auto pixel = project(k, direction);
        if (!pixel) continue;
        const double inside = std::min(std::min(pixel->x, k.width - pixel->x), std::min(pixel->y, k.height - pixel->y));
        border = std::clamp(inside / (double(shader::kGatherBorder) * k.width), 0.0, 1.0);
      }
      const double angle = std::atan2(glm::length(glm::cross(turned, direction)), glm::dot(turned, direction));
      value = float(border / (double(shader::kGatherAngleFloor) + angle));
    }
  return values;
}

float coverage(const Values& sum) {
  float total = 0;
  for (const float value : sum) total += std::sqrt(value);
  return total;
}

float coverageWith(const Values& sum, const Values& more) {
  float total = 0;
  for (std::size_t p = 0; p < kSamplePoints; ++p) total += std::sqrt(sum[p] + more[p]);
  return total;
}

void add(Values& sum, const Values& more) {
  for (std::size_t p = 0; p < kSamplePoints; ++p) sum[p] += more[p];
}

// Adds the others instead of subtracting one: a difference would leave rounding errors where the sum is 0.
Values sumWithout(const std::vector<Candidate>& pool, const std::vector<std::size_t>& members, std::size_t left) {
  Values sum{};
  for (std::size_t m = 0; m < members.size(); ++m)
    if (m != left) add(sum, pool[members[m]].value);
  return sum;
}

// Estimates the weight that sightOf in shaders/render/gather.glsl gives: a photograph at the view's own position counts
// alone. Visibility and resolution are unknown here, and the border is part of `value`.
float gatherWeight(float value, double distance) {
  if (!(value > 0)) return 0;
  const double beyond =
      1 / double(value) - double(shader::kGatherAngleFloor) + double(shader::kGatherDistanceCost) * distance;
  const double t = std::clamp(beyond / double(shader::kGatherOwnPoseCost), 0.0, 1.0), apart = t * t * (3 - 2 * t);
  return value / std::max(float(apart), shader::kGatherMinApart);
}

// Shares as the gather blends: at each ray and depth the four best photographs, each by its worth above that of the
// fifth.
std::vector<double> sharesOf(const std::vector<Candidate>& pool, const std::vector<std::size_t>& members,
                             const std::vector<float>& fade, double spacing) {
  constexpr std::size_t kColours = 4;
  std::vector<double> shares(members.size(), 0.0);
  std::vector<std::pair<float, std::size_t>> best(members.size());
  for (std::size_t point = 0; point < kSamplePoints; ++point) {
    for (std::size_t m = 0; m < members.size(); ++m) {
      const Candidate& one = pool[members[m]];
      best[m] = {fade[m] * gatherWeight(one.value[point], one.distance / spacing), m};
    }
    std::ranges::sort(best, std::ranges::greater());
    const float least = best.size() > kColours ? best[kColours].first : 0;
    float sum = 0;
    for (std::size_t i = 0; i < std::min(kColours, best.size()); ++i) sum += best[i].first - least;
    for (std::size_t i = 0; sum > 0 && i < std::min(kColours, best.size()); ++i)
      shares[best[i].second] += double((best[i].first - least) / sum);
  }
  const double total = std::accumulate(shares.begin(), shares.end(), 0.0);
  for (double& share : shares) share = total > 0 ? share / total : 1 / double(shares.size());
  return shares;
}

struct Replacement {
  std::size_t candidate = 0;
  float coverage = 0;
};

// Returns the best photograph outside the set to replace a member.
Replacement bestReplacement(const std::vector<Candidate>& pool, const std::vector<bool>& taken, const Values& others) {
  Replacement best{pool.size(), coverage(others)};
  for (std::size_t i = 0; i < pool.size(); ++i)
    if (!taken[i])
      if (const float with = coverageWith(others, pool[i].value); with > best.coverage) best = {i, with};
  return best;
}

}  // namespace

std::vector<std::uint32_t> gatherableBackdrops(const Scene& scene) {
  std::vector<std::uint32_t> result;
  for (std::uint32_t b = 0; b < scene.backdrops.size(); ++b) {
    const Cell& backdrop = scene.backdrops[b];
    if (!backdrop.mesh.confirmations.empty() && !scene.nodes[backdrop.members[0]].depthFile.empty())
      result.push_back(b);
  }
  return result;
}

std::vector<PlannedPhotograph> choosePhotographs(const Scene& scene, const GatherStatistics& bounds,
                                                 const std::vector<Camera>& views, const Pose& middle,
                                                 std::size_t count) {
  const std::vector<glm::dvec3> rays = raysOf(views, middle);
  std::vector<Candidate> pool;
  for (const std::uint32_t b : gatherableBackdrops(scene)) {
    const Camera& camera = scene.nodes[scene.backdrops[b].members[0]].camera;
    Candidate candidate{b, glm::distance(camera.pose.position, middle.position), 0,
                        valuesOf(camera, middle, rays, bounds.medianInverseDepth)};
    candidate.alone = coverage(candidate.value);
    if (candidate.alone > 0) pool.push_back(candidate);
  }
  std::stable_sort(pool.begin(), pool.end(), [](const Candidate& a, const Candidate& b) { return a.alone > b.alone; });
  if (pool.size() > kMaxPoolSize) pool.resize(kMaxPoolSize);
  count = std::min(count, pool.size());
  if (count == 0) return {};

  std::vector<std::size_t> members;
  std::vector<bool> taken(pool.size(), false);
  Values sum{};
  while (members.size() < count) {
    const Replacement best = bestReplacement(pool, taken, sum);
    if (best.candidate == pool.size()) break;
    taken[best.candidate] = true;
    add(sum, pool[best.candidate].value);
    members.push_back(best.candidate);
  }
  std::vector<float> fade(members.size(), 1.0f);
  if (members.size() < pool.size()) {
    const std::size_t maxRounds = 2 * members.size();
    for (std::size_t round = 0; round < maxRounds; ++round) {
      float most = 0;
      std::size_t outgoing = 0, incoming = pool.size();
      for (std::size_t m = 0; m < members.size(); ++m) {
        const Values others = sumWithout(pool, members, m);
        const float here = coverageWith(others, pool[members[m]].value);
        const Replacement best = bestReplacement(pool, taken, others);
        const float loss = here - coverage(others), gain = best.coverage - coverage(others);
        fade[m] = gain > 0 ? float(std::clamp((double(loss) / double(gain) - 1) / kFadeShare, 0.0, 1.0)) : 1.0f;
        if (const float won = best.coverage - here; won > most && double(won) > kMinRelativeGain * double(here)) {
          most = won;
          outgoing = m;
          incoming = best.candidate;
        }
      }
      if (incoming == pool.size()) break;
      taken[members[outgoing]] = false;
      taken[incoming] = true;
      members[outgoing] = incoming;
    }
  }
  const std::vector<double> shares = sharesOf(pool, members, fade, bounds.spacing);
  std::vector<PlannedPhotograph> result;
  for (std::size_t m = 0; m < members.size(); ++m) {
    const Candidate& one = pool[members[m]];
    result.push_back(
        {scene.backdrops[one.backdrop].members[0], one.backdrop, double(fade[m]), one.distance, shares[m]});
  }
  std::vector<std::size_t> order(result.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return pool[members[a]].alone > pool[members[b]].alone; });
  std::vector<PlannedPhotograph> sorted;
  for (const std::size_t m : order) sorted.push_back(result[m]);
  return sorted;
}

GatherStatistics gatherStatistics(const Scene& scene, const std::stop_token& stop) {
  GatherStatistics bounds;
  std::vector<Camera> cameras;
  for (const Node& node : scene.nodes) cameras.push_back(node.camera);
  if (!cameras.empty()) bounds.spacing = captureSpacing(cameras, stop);
  std::vector<double> confirmed, residuals;
  for (const Cell& backdrop : scene.backdrops)
    for (std::size_t p = 0; p < backdrop.mesh.confirmations.size(); ++p)
      if (backdrop.mesh.confirmations[p] > 0) confirmed.push_back(double(backdrop.mesh.inverseDistance[p]));
  if (!confirmed.empty()) bounds.medianInverseDepth = median(std::move(confirmed));
  for (const Cell& cell : scene.cells)
    if (std::isfinite(cell.quality.residualPx)) residuals.push_back(cell.quality.residualPx);
  if (!residuals.empty()) bounds.residualPx = median(std::move(residuals));
  return bounds;
}

}  // namespace ibr
