// SPDX-License-Identifier: Apache-2.0
#include "author/video/frame_motion.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <opencv2/core.hpp>
#include <utility>
#include <vector>

#include "base/median.h"

namespace ibr {
namespace {

constexpr double kFocal = 0.85;  // of the longer side
constexpr std::size_t kFewest = 12;

using Pair = std::pair<glm::dvec3, glm::dvec3>;  // unit directions of a point in both frames

// Rotation that maps the first directions to the second ones with the least sum of residuals: Kabsch 1976, with weights
// that are the inverse of each residual.
cv::Matx33d rotationOf(std::span<const Pair> pairs) {
  constexpr int kRounds = 5;
  constexpr double kSmallest = 1e-4;
  std::vector<double> weights(pairs.size(), 1);
  cv::Matx33d rotation = cv::Matx33d::eye();
  for (int round = 0; round < kRounds; ++round) {
    cv::Matx33d sum = cv::Matx33d::zeros();
    for (std::size_t i = 0; i < pairs.size(); ++i)
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) sum(r, c) += weights[i] * pairs[i].second[r] * pairs[i].first[c];
    cv::Matx33d u, vt;
    cv::Matx31d singular;
    cv::SVD::compute(sum, singular, u, vt);
    cv::Matx33d sign = cv::Matx33d::eye();
    sign(2, 2) = cv::determinant(u * vt) < 0 ? -1 : 1;
    rotation = u * sign * vt;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const glm::dvec3& a = pairs[i].first;
      const cv::Vec3d turned = rotation * cv::Vec3d(a.x, a.y, a.z);
      const glm::dvec3 residual = glm::dvec3(turned[0], turned[1], turned[2]) - pairs[i].second;
      weights[i] = 1 / std::max(kSmallest, glm::length(residual));
    }
  }
  return rotation;
}

}  // namespace

FrameMotion motionBetween(std::span<const TrackedPoint> from, std::span<const TrackedPoint> to, int width, int height) {
  const double side = std::max(width, height);
  const auto direction = [&](const TrackedPoint& p) {
    return glm::normalize(glm::dvec3(p.x - 0.5 * width, p.y - 0.5 * height, kFocal * side));
  };
  std::vector<Pair> pairs;
  std::vector<double> shifts;
  for (auto a = from.begin(), b = to.begin(); a != from.end() && b != to.end();) {
    if (a->id != b->id) {
      ++(a->id < b->id ? a : b);
      continue;
    }
    pairs.emplace_back(direction(*a), direction(*b));
    shifts.push_back(std::hypot(a->x - b->x, a->y - b->y) / side);
    ++a, ++b;
  }
  if (pairs.size() < kFewest) return {};
  const cv::Matx33d rotation = rotationOf(pairs);
  std::vector<double> residuals;
  for (const auto& [a, b] : pairs) {
    const cv::Vec3d turned = rotation * cv::Vec3d(a.x, a.y, a.z);
    residuals.push_back(kFocal * glm::length(glm::dvec3(turned[0], turned[1], turned[2]) - b));
  }
  return {median(std::move(shifts)), median(std::move(residuals)),
          double(pairs.size()) / double(std::min(from.size(), to.size()))};
}

}  // namespace ibr
