// SPDX-License-Identifier: Apache-2.0
#include "author/depth/patch_cost.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

#include "author/geometry/mean_frame.h"
#include "base/wide.h"

namespace ibr {
namespace {

constexpr float kColourScale = 25;   // difference at which a sample's weight falls to 1/e, 8-bit levels
constexpr float kNoiseVariance = 4;  // variance below which a patch counts as noise

// Sample positions of a patch relative to its middle, in sample distances. Padding samples lie at the middle.
constexpr std::array<float, kPaddedSamples> offsets(bool down) {
  std::array<float, kPaddedSamples> result{};
  for (std::size_t k = 0; k < kPatchSamples; ++k)
    result[k] = float(int(down ? k / kPatchSide : k % kPatchSide) - kPatchSide / 2);
  return result;
}
constexpr std::array<float, kPaddedSamples> kAcross = offsets(false), kDown = offsets(true);

// Sums in a fixed order, that of vectors of kLanes, so that the result does not depend on vectorisation.
[[gnu::always_inline]] inline float total(const float* __restrict values) {
  float lanes[kLanes];
  for (std::size_t l = 0; l < kLanes; ++l) lanes[l] = values[l];
  for (std::size_t k = kLanes; k < kPaddedSamples; k += kLanes)
    for (std::size_t l = 0; l < kLanes; ++l) lanes[l] += values[k + l];
  return ((lanes[0] + lanes[4]) + (lanes[2] + lanes[6])) + ((lanes[1] + lanes[5]) + (lanes[3] + lanes[7]));
}

[[gnu::always_inline]] inline float costOfPatch(const PatchSource* source, const Patch* patch,
                                                const DepthPlane* plane) {
  const float inverseDepth = plane->inverseDepth + plane->slope.x * patch->off.x + plane->slope.y * patch->off.y;
  const glm::mat3& a = source->a;
  const glm::vec3& b = source->b;
  float middle[3], right[3], down[3];
  for (int c = 0; c < 3; ++c) {
    middle[c] = a[0][c] * patch->middle.x + a[1][c] * patch->middle.y + a[2][c] + inverseDepth * b[c];
    right[c] = float(kPatchSpacing) * (a[0][c] + plane->slope.x * b[c]);
    down[c] = float(kPatchSpacing) * (a[1][c] + plane->slope.y * b[c]);
  }
  constexpr float kHalf = kPatchSide / 2;
  if (!(middle[2] > kHalf * (std::abs(right[2]) + std::abs(down[2])))) return kUnseenPatchCost;
  const ImageF& grey = source->view->grey;
  alignas(32) float u[kPaddedSamples], v[kPaddedSamples];
  for (std::size_t k = 0; k < kPaddedSamples; ++k) {
    const float z = 1 / (middle[2] + kAcross[k] * right[2] + kDown[k] * down[2]);
    u[k] = (middle[0] + kAcross[k] * right[0] + kDown[k] * down[0]) * z - 0.5f;
    v[k] = (middle[1] + kAcross[k] * right[1] + kDown[k] * down[1]) * z - 0.5f;
  }
  const float wide = float(grey.width - 1), high = float(grey.height - 1);
  for (const std::size_t corner :
       {std::size_t(0), std::size_t(kPatchSide - 1), kPatchSamples - kPatchSide, kPatchSamples - 1})
    if (!(u[corner] >= 0 && v[corner] >= 0 && u[corner] < wide && v[corner] < high)) return kUnseenPatchCost;
  const Image8& mask = source->view->mask;
  constexpr std::size_t kMiddle = kPatchSamples / 2;
  if (!mask.empty() && !mask.pixel(int(u[kMiddle] + 0.5f), int(v[kMiddle] + 0.5f))[0]) return kUnseenPatchCost;
  const float* __restrict const pixels = grey.values.data();
  const int row = grey.width;
  alignas(32) float value[kPaddedSamples], square[kPaddedSamples], product[kPaddedSamples];
  for (std::size_t k = 0; k < kPaddedSamples; ++k) {
    const int x = int(u[k]), y = int(v[k]), at = y * row + x;
    const float across = u[k] - float(x), along = v[k] - float(y);
    const float top = pixels[at] + across * (pixels[at + 1] - pixels[at]);
    const float bottom = pixels[at + row] + across * (pixels[at + row + 1] - pixels[at + row]);
    value[k] = top + along * (bottom - top);
  }
  const float* const weight = patch->weight.data();
  const float* const from = patch->from.data();
  for (std::size_t k = 0; k < kPaddedSamples; ++k) {
    product[k] = from[k] * value[k];
    const float weighted = weight[k] * value[k];
    square[k] = weighted * value[k];
    value[k] = weighted;
  }
  const float mean = total(value), spread = total(square) - mean * mean;
  return 1 - total(product) / std::sqrt(patch->variance * ((spread > 0 ? spread : 0) + kNoiseVariance));
}

}  // namespace

Patch patchAt(const ImageF& grey, glm::vec2 point) {
  const glm::ivec2 nearest = glm::min(glm::ivec2(point), glm::ivec2(grey.width, grey.height) - 1);
  Patch patch{};
  patch.middle = glm::vec2(nearest) + 0.5f;
  patch.off = patch.middle - point;
  std::array<float, kPatchSamples> value;
  float sum = 0, mean = 0;
  for (std::size_t k = 0; k < kPatchSamples; ++k) {
    const int u = nearest.x + kPatchSpacing * (int(k % kPatchSide) - kPatchSide / 2),
              v = nearest.y + kPatchSpacing * (int(k / kPatchSide) - kPatchSide / 2);
    value[k] = grey.pixel(std::clamp(u, 0, grey.width - 1), std::clamp(v, 0, grey.height - 1))[0];
  }
  for (std::size_t k = 0; k < kPatchSamples; ++k) {
    patch.weight[k] = std::exp(-std::abs(value[k] - value[kPatchSamples / 2]) / kColourScale);
    sum += patch.weight[k];
    mean += patch.weight[k] * value[k];
  }
  mean /= sum;
  patch.variance = kNoiseVariance;
  for (std::size_t k = 0; k < kPatchSamples; ++k) {
    patch.weight[k] /= sum;
    patch.from[k] = patch.weight[k] * (value[k] - mean);
    patch.variance += patch.from[k] * (value[k] - mean);
  }
  return patch;
}

std::vector<PatchSource> patchSources(const Camera& photograph, std::span<const SweepView> sources) {
  std::vector<PatchSource> result;
  for (const SweepView& source : sources) {
    const FrameToMember map = frameToMember(photograph, source.camera);
    result.push_back({glm::mat3(map.a), glm::vec3(map.b), &source});
  }
  return result;
}

float patchCost(const PatchSource& source, const Patch& patch, const DepthPlane& plane) {
  return runVectorised<costOfPatch>(&source, &patch, &plane);
}

}  // namespace ibr
