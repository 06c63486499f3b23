// SPDX-License-Identifier: Apache-2.0
#include "author/depth_clean.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace ibr {
namespace {

// Marks regions of fewer than `least` pixels.
std::vector<bool> speckles(const ImageF& map, float step, int least) {
  const int width = map.width, height = map.height;
  std::vector<bool> seen(map.values.size(), false), speckle(map.values.size(), false);
  std::vector<int> region;
  for (int seed = 0; seed < width * height; ++seed) {
    if (seen[std::size_t(seed)]) continue;
    seen[std::size_t(seed)] = true;
    region.assign(1, seed);
    for (std::size_t k = 0; k < region.size(); ++k) {
      const int at = region[k], x = at % width, y = at / width;
      auto grow = [&](int to) {
        if (seen[std::size_t(to)] || std::abs(map.values[std::size_t(to)] - map.values[std::size_t(at)]) > step) return;
        seen[std::size_t(to)] = true;
        region.push_back(to);
      };
      if (x > 0) grow(at - 1);
      if (x + 1 < width) grow(at + 1);
      if (y > 0) grow(at - width);
      if (y + 1 < height) grow(at + width);
    }
    if (int(region.size()) < least)
      for (const int at : region) speckle[std::size_t(at)] = true;
  }
  return speckle;
}

}  // namespace

void cleanDepth(ImageF& map, float step, int least) {
  cv::Mat view(map.height, map.width, CV_32FC1, map.values.data());
  cv::medianBlur(view.clone(), view, 5);
  const std::vector<bool> speckle = speckles(map, step, least);
  constexpr float kNone = std::numeric_limits<float>::infinity();
  std::vector<float> fromLeft(std::size_t(map.width));
  for (int y = 0; y < map.height; ++y) {
    const std::size_t row = std::size_t(y) * std::size_t(map.width);
    float last = kNone;
    for (int x = 0; x < map.width; ++x) {
      if (!speckle[row + std::size_t(x)]) last = map.values[row + std::size_t(x)];
      fromLeft[std::size_t(x)] = last;
    }
    last = kNone;
    for (int x = map.width - 1; x >= 0; --x) {
      float& value = map.values[row + std::size_t(x)];
      if (!speckle[row + std::size_t(x)]) {
        last = value;
      } else if (const float fill = std::min(last, fromLeft[std::size_t(x)]); fill < kNone) {
        value = fill;
      }
    }
  }
}

}  // namespace ibr
