// SPDX-License-Identifier: Apache-2.0
#include "batch/evaluate/depth_scores.h"

#include <cassert>
#include <cmath>

#include "ibr/scene.h"

namespace ibr::app {
namespace {

// Channels of FrameBuffers::surface and ::confidence.
constexpr std::size_t kDepth = 0, kTier = 1, kUncertainty = 1;

bool isDrawn(float tier) {
  return tier >= 0 && int(tier) < kTierFilled;
}

}  // namespace

DepthScores depthScores(const ImageF& inverseDepth, const ImageF& truth, const DepthTolerance& tolerance) {
  assert(inverseDepth.values.size() == truth.values.size());
  const double pxPerInverseDepth = tolerance.focalPx * tolerance.baseline;
  double count = 0, right = 0, far = 0, near = 0;
  for (std::size_t at = 0; at < truth.values.size(); ++at) {
    if (!(truth.values[at] > 0)) continue;
    ++count;
    const double drawn = double(inverseDepth.values[at]);
    if (drawn < 0) continue;
    const double off = pxPerInverseDepth * (drawn - 1 / double(truth.values[at]));
    ++(std::abs(off) <= 1 ? right : off < 0 ? far : near);
  }
  return {right / count, far / count, near / count};
}

DeviationScores deviationScores(const FrameBuffers& buffers, const ImageF& truth) {
  assert(buffers.surface.width == truth.width && buffers.surface.height == truth.height);
  double count = 0, one = 0, two = 0;
  for (int y = 0; y < truth.height; ++y)
    for (int x = 0; x < truth.width; ++x) {
      const auto here = buffers.surface.pixel(x, y);
      const double depth = double(truth.pixel(x, y)[0]);
      if (!(depth > 0) || int(here[kTier]) != kTierConsistent || !isDrawn(here[kTier])) continue;
      const double off = std::abs(1 / double(here[kDepth]) - 1 / depth),
                   deviation = double(buffers.confidence.pixel(x, y)[kUncertainty]);
      ++count;
      one += off <= deviation;
      two += off <= 2 * deviation;
    }
  return {one / count, two / count};
}

ImageF drawnInverseDepth(const FrameBuffers& buffers) {
  const ImageF& surface = buffers.surface;
  ImageF result(surface.width, surface.height, 1, -1.0f);
  for (int y = 0; y < surface.height; ++y)
    for (int x = 0; x < surface.width; ++x)
      if (const auto here = surface.pixel(x, y); isDrawn(here[kTier])) result.pixel(x, y)[0] = 1.0f / here[kDepth];
  return result;
}

double guessedShare(const FrameBuffers& buffers) {
  const ImageF& surface = buffers.surface;
  std::size_t guessed = 0;
  for (int y = 0; y < surface.height; ++y)
    for (int x = 0; x < surface.width; ++x) {
      const auto here = surface.pixel(x, y);
      guessed += !isDrawn(here[kTier]) || int(here[kTier]) == kTierCompleted;
    }
  return double(guessed) / (double(surface.width) * surface.height);
}

}  // namespace ibr::app
