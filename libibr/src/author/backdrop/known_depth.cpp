// SPDX-License-Identifier: Apache-2.0
#include "author/backdrop/known_depth.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <utility>
#include <vector>

#include "author/backdrop/complete_depth.h"
#include "author/geometry/mean_frame.h"

namespace ibr {
namespace {

// Inverse depths by pixel, in any order.
class Samples {
 public:
  Samples(int width, int height) : width_(width), height_(height) {}

  void add(glm::dvec2 at, double inverseDepth) {
    if (at.x >= 0 && at.y >= 0 && at.x < width_ && at.y < height_)
      samples_.emplace_back(int(at.y) * width_ + int(at.x), float(inverseDepth));
  }
  ImageF medians() && {
    std::sort(samples_.begin(), samples_.end());
    ImageF result(width_, height_, 1, kUnknownDepth);
    for (std::size_t first = 0, last = 0; first < samples_.size(); first = last) {
      while (last < samples_.size() && samples_[last].first == samples_[first].first) ++last;
      result.values[std::size_t(samples_[first].first)] = samples_[(first + last - 1) / 2].second;
    }
    return result;
  }

 private:
  int width_, height_;
  std::vector<std::pair<int, float>> samples_;
};

}  // namespace

ImageF depthOfPoints(const Camera& camera, std::span<const glm::dvec3> points) {
  Samples samples(camera.intrinsics.width, camera.intrinsics.height);
  for (const glm::dvec3& point : points) {
    const double w = inverseDepth(camera, point);
    const auto at = project(camera.intrinsics, glm::conjugate(camera.pose.rotation) * (point - camera.pose.position));
    if (at && w > 0 && std::isfinite(w)) samples.add(*at, w);
  }
  return std::move(samples).medians();
}

}  // namespace ibr
