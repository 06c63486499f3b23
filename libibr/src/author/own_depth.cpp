// SPDX-License-Identifier: Apache-2.0
#include "author/own_depth.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "author/complete_depth.h"
#include "author/depth_clean.h"
#include "author/mean_frame.h"

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

ImageF ownDepth(const DenseMatch& match, const Camera& member, std::size_t index, glm::ivec2 size) {
  const FrameToMember map = frameToMember(match.frame, member);
  const glm::dvec2 scale(double(size.x) / member.intrinsics.width, double(size.y) / member.intrinsics.height);
  Samples samples(size.x, size.y);
  const ImageF& depth = match.inverseDepth;
  for (int y = 0; y < depth.height; ++y)
    for (int x = 0; x < depth.width; ++x) {
      if (!match.seen[index].pixel(x, y)[0]) continue;
      const double w = depth.pixel(x, y)[0];
      const glm::dvec3 h = map.homogeneous({x + 0.5, y + 0.5}, w);
      if (h.z > 0) samples.add(scale * glm::dvec2(h.x / h.z, h.y / h.z), w / h.z);
    }
  return std::move(samples).medians();
}

ImageF depthOfPoints(const Camera& camera, std::span<const glm::dvec3> points) {
  Samples samples(camera.intrinsics.width, camera.intrinsics.height);
  for (const glm::dvec3& point : points) {
    const double w = inverseDepth(camera, point);
    const auto at = project(camera.intrinsics, glm::conjugate(camera.pose.rotation) * (point - camera.pose.position));
    if (at && w > 0 && std::isfinite(w)) samples.add(*at, w);
  }
  return std::move(samples).medians();
}

ImageF medianDepth(std::span<const ImageF> maps) {
  ImageF result(maps[0].width, maps[0].height, 1, kUnknownDepth);
  std::vector<float> values;
  for (std::size_t at = 0; at < result.values.size(); ++at) {
    values.clear();
    for (const ImageF& map : maps)
      if (map.values[at] >= 0) values.push_back(map.values[at]);
    if (values.empty()) continue;
    const auto middle = values.begin() + std::ptrdiff_t((values.size() - 1) / 2);
    std::nth_element(values.begin(), middle, values.end());
    result.values[at] = *middle;
  }
  return result;
}

void dropIslands(ImageF& inverseDepth, double parallaxPx) {
  constexpr int kLeast = 60;         // px
  constexpr float kStep = 2.0f;      // px of parallax between neighbours of one surface, at most
  constexpr float kNowhere = -1e6f;  // far from all that is known
  ImageF parallax = inverseDepth;
  for (float& w : parallax.values) w = w >= 0 ? float(parallaxPx * double(w)) : kNowhere;
  const std::vector<bool> island = speckles(parallax, kStep, kLeast);
  for (std::size_t at = 0; at < island.size(); ++at)
    if (island[at]) inverseDepth.values[at] = kUnknownDepth;
}

}  // namespace ibr
