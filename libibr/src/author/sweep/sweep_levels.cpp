// SPDX-License-Identifier: Apache-2.0
#include "author/sweep/sweep_levels.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>

#include "author/geometry/mean_frame.h"

namespace ibr {
namespace {

constexpr double kMinLevels = 64, kMaxLevels = 256;  // range of the number of levels among the tracks
constexpr double kFarFactor = 0.7,
                 kNearFactor = 2.0;         // factors by which the range exceeds the tracks' inverse depths …
constexpr double kCompactNearFactor = 1.4;  // … for similar depths, as over flat ground or along a wall:
constexpr double kCompactRatio = 0.5;       // the farthest is more than this share of the nearest
constexpr double kGrowth = 1.3;             // of steps from there to infinity

}  // namespace

double SweepLevels::at(double level) const {
  const std::size_t below = std::min(std::size_t(level), inverseDepth.size() - 2);
  const double part = level - double(below);
  return inverseDepth[below] + part * (inverseDepth[below + 1] - inverseDepth[below]);
}

SweepLevels sweepLevels(const Camera& frame, std::span<const Camera> members, std::vector<double> w) {
  std::sort(w.begin(), w.end());
  auto percentile = [&](double share) { return w[std::size_t(share * double(w.size() - 1) + 0.5)]; };
  const double far = percentile(0.005), near = percentile(0.995);
  // Tracks miss areas without texture: the sky and, with wide lenses, the nearest part of the ground.
  const double highest = (far > kCompactRatio * near ? kCompactNearFactor : kNearFactor) * near,
               lowest = kFarFactor * far;

  std::vector<FrameToMember> maps;
  for (const Camera& member : members) maps.push_back(frameToMember(frame, member));
  std::vector<double> motion;  // px between members, over the whole range
  constexpr int kSamples = 16;
  for (int sy = 0; sy < kSamples; ++sy)
    for (int sx = 0; sx < kSamples; ++sx) {
      const glm::dvec2 pixel((sx + 0.5) * frame.intrinsics.width / kSamples,
                             (sy + 0.5) * frame.intrinsics.height / kSamples);
      double largest = 0;
      for (std::size_t i = 0; i < maps.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) {
          // Measured in the middle of the range: at its near end the members' images are far apart.
          constexpr double kPart = 0.02;
          const double middle = 0.5 * (lowest + highest), next = middle + kPart * (highest - lowest);
          const auto i0 = maps[i](pixel, middle), i1 = maps[i](pixel, next);
          const auto j0 = maps[j](pixel, middle), j1 = maps[j](pixel, next);
          if (i0 && i1 && j0 && j1) largest = std::max(largest, glm::distance(*i1 - *i0, *j1 - *j0) / kPart);
        }
      motion.push_back(largest);
    }
  std::nth_element(motion.begin(), motion.begin() + std::ptrdiff_t(motion.size() * 9 / 10), motion.end());
  const double pixels = std::clamp(motion[motion.size() * 9 / 10], kMinLevels, kMaxLevels);

  SweepLevels levels{{}, (highest - lowest) / std::ceil(pixels), lowest};
  for (double v = highest, step = levels.step; v > 0.5 * step; v -= step) {
    levels.inverseDepth.push_back(v);
    if (v <= lowest) step *= kGrowth;
  }
  levels.inverseDepth.push_back(0.0);
  std::reverse(levels.inverseDepth.begin(), levels.inverseDepth.end());
  return levels;
}

}  // namespace ibr
