// SPDX-License-Identifier: Apache-2.0
#include "batch/evaluate/eye_agreement.h"

#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <glm/vec2.hpp>
#include <vector>

#include "shared/report/statistics.h"

namespace ibr::app {
namespace {

constexpr double kSameDepth = 0.02;
enum Channel : std::size_t { kDepth, kTier, kRank };  // of FrameBuffers::surface

// World point at a pixel's centre and a `depth` along the viewing axis.
glm::dvec3 pointAt(const Camera& eye, int x, int y, double depth) {
  const glm::dvec3 ray = unproject(eye.intrinsics, {x + 0.5, y + 0.5});
  return eye.pose.position + eye.pose.rotation * (ray * (depth / -ray.z));
}

// Interpolates at a position in pixels, whose four neighbours must lie in the image.
double bilinear(const Image8& image, glm::dvec2 at, std::size_t channel) {
  const glm::dvec2 corner = glm::floor(at - 0.5), part = at - 0.5 - corner;
  const auto level = [&](int dx, int dy) {
    return double(image.pixel(int(corner.x) + dx, int(corner.y) + dy)[channel]);
  };
  return glm::mix(glm::mix(level(0, 0), level(1, 0), part.x), glm::mix(level(0, 1), level(1, 1), part.x), part.y);
}

}  // namespace

EyeAgreement eyeAgreement(const SceneRenderer::Picture& left, const Camera& leftEye,
                          const SceneRenderer::Picture& right, const Camera& rightEye) {
  const ImageF &here = left.buffers->surface, &there = right.buffers->surface;
  const glm::dquat toRight = glm::conjugate(rightEye.pose.rotation);
  std::vector<double> differences;
  std::size_t same = 0;
  for (int y = 0; y < here.height; ++y)
    for (int x = 0; x < here.width; ++x) {
      const auto surface = here.pixel(x, y);
      if (surface[kRank] < 0 || !std::isfinite(surface[kDepth])) continue;
      const glm::dvec3 seen = toRight * (pointAt(leftEye, x, y, double(surface[kDepth])) - rightEye.pose.position);
      const auto at = project(rightEye.intrinsics, seen);
      if (!at || at->x < 0.5 || at->y < 0.5 || at->x >= there.width - 0.5 || at->y >= there.height - 0.5) continue;
      const auto other = there.pixel(int(at->x), int(at->y));
      if (other[kRank] < 0 || !(std::abs(double(other[kDepth]) + seen.z) <= kSameDepth * -seen.z)) continue;
      same += surface[kRank] == other[kRank] && surface[kTier] == other[kTier];
      double difference = 0;
      for (std::size_t c = 0; c < 3; ++c)
        difference += std::abs(left.image.pixel(x, y)[c] - bilinear(right.image, *at, c)) / 3;
      differences.push_back(difference);
    }
  if (differences.empty()) return {};
  const double count = double(differences.size());
  return {.seenByBoth = count / double(std::size_t(here.width) * std::size_t(here.height)),
          .sameCell = double(same) / count,
          .difference = mean(differences),
          .difference95 = quantile(differences, 0.95)};
}

}  // namespace ibr::app
