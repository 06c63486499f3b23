// SPDX-License-Identifier: Apache-2.0
#include "author/sweep/depth_clean.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace ibr {
namespace {

constexpr int kPlaneRadius = 3;             // px
constexpr float kMaxFirstFitSteps = 6.0f;   // maximum distance from the pixel's own value for the first fit, steps …
constexpr float kMaxSecondFitSteps = 1.0f;  // … and from that fit for the second
constexpr float kMinOnPlane = 12.0f;        // px
constexpr float kMaxPullSteps = 2.0f;       // steps; a fit farther off belongs to another surface

}  // namespace

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

ImageF fitPlanes(const ImageF& map, float step) {
  ImageF planes(map.width, map.height, 3);
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) {
      const float here = map.pixel(x, y)[0];
      float value = here, slopeX = 0, slopeY = 0;
      for (const float limit : {kMaxFirstFitSteps * step, kMaxSecondFitSteps * step}) {
        // Least squares of value + slopeX·dx + slopeY·dy, by central moments.
        float n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0, syy = 0, sw = 0, sxw = 0, syw = 0;
        for (int v = std::max(y - kPlaneRadius, 0); v <= std::min(y + kPlaneRadius, map.height - 1); ++v)
          for (int u = std::max(x - kPlaneRadius, 0); u <= std::min(x + kPlaneRadius, map.width - 1); ++u) {
            const float dx = float(u - x), dy = float(v - y), w = map.pixel(u, v)[0];
            if (std::abs(w - (value + slopeX * dx + slopeY * dy)) > limit) continue;
            const float off = w - here;
            n += 1, sx += dx, sy += dy, sxx += dx * dx, sxy += dx * dy, syy += dy * dy;
            sw += off, sxw += dx * off, syw += dy * off;
          }
        if (n < kMinOnPlane) break;
        constexpr float kRidge = 0.01f;  // keeps a row of pixels from tilting
        const float cxx = sxx - sx * sx / n + kRidge, cyy = syy - sy * sy / n + kRidge, cxy = sxy - sx * sy / n;
        const float cxw = sxw - sx * sw / n, cyw = syw - sy * sw / n, determinant = cxx * cyy - cxy * cxy;
        slopeX = (cxw * cyy - cyw * cxy) / determinant;
        slopeY = (cyw * cxx - cxw * cxy) / determinant;
        value = here + (sw - slopeX * sx - slopeY * sy) / n;
      }
      if (std::abs(value - here) > kMaxPullSteps * step) value = here, slopeX = slopeY = 0;
      const auto plane = planes.pixel(x, y);
      plane[0] = value;
      plane[1] = slopeX;
      plane[2] = slopeY;
    }
  return planes;
}

ImageF enlarged(const ImageF& planes, int width, int height) {
  ImageF result(width, height, 1);
  const float scaleX = float(planes.width) / float(width), scaleY = float(planes.height) / float(height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const float u = (float(x) + 0.5f) * scaleX, v = (float(y) + 0.5f) * scaleY;
      const int iu = std::min(int(u), planes.width - 1), iv = std::min(int(v), planes.height - 1);
      const auto plane = planes.pixel(iu, iv);
      const float value = plane[0] + plane[1] * (u - 0.5f - float(iu)) + plane[2] * (v - 0.5f - float(iv));
      result.pixel(x, y)[0] = std::max(value, 0.0f);
    }
  return result;
}

}  // namespace ibr
