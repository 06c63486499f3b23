// SPDX-License-Identifier: Apache-2.0
// Value of a photograph for the gather at each of a grid of rays and at two depths:
//
//   value = border / (kGatherAngleFloor + angle between the view's ray and the photograph's ray)
//
// The inner loops of the choice of photographs, in single precision, compiled for AVX2 as well (base/wide.h): both
// versions give the same bits. Pure.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "ibr/camera.h"

namespace ibr {

inline constexpr std::size_t kSampleColumns = 16, kSampleRows = 9;
inline constexpr std::size_t kSampleRays = kSampleColumns * kSampleRows;
inline constexpr std::array kSampleDepths{1.6, 0.4};  // of the median ρ
inline constexpr std::size_t kSamplePoints = kSampleRays * kSampleDepths.size();

/// By ray and depth.
struct SampleValues {
  std::array<float, kSamplePoints> at{};
};

/// Directions (x, y, −1) over all views, in the axes of the middle pose.
struct SampleRays {
  std::array<float, kSampleRays> x, y;
};
SampleRays sampleRays(std::span<const Camera> views, const Pose& middle);

/// Returns the values of a photograph. `medianInverseDepth`: GatherStatistics.
SampleValues photographValues(const Camera& photograph, const Pose& middle, const SampleRays& rays,
                              double medianInverseDepth);

/// Returns Σ √a.
float coverage(const SampleValues& a);

/// Returns Σ √(a + b).
float coverage(const SampleValues& a, const SampleValues& b);

/// Adds `b` to `a`.
void add(SampleValues& a, const SampleValues& b);

/// Slopes of Σ √a at a > 0: for any b >= 0, Σ √b <= Σ √a + linear(slopes, b) − linear(slopes, a).
struct CoverageSlopes {
  SampleValues slope;  // 1 / (2 √a); 0 where a is 0 …
  SampleValues root;   // … and there 1, as a factor of √b; 0 elsewhere
};
CoverageSlopes coverageSlopes(const SampleValues& a);
float linear(const CoverageSlopes& slopes, const SampleValues& b);

/// Turns values into estimates of the weights that sightOf in shaders/render/gather.glsl gives, times `fade`: a
/// photograph at the view's own position counts alone. Visibility and resolution are unknown here, and the border is
/// part of the value. `distance`: from the view, in capture spacings.
void toGatherWeights(SampleValues& values, double distance, float fade);

/// Sets each photograph's share of the colours as the gather blends them: at each ray and depth the best four
/// photographs, each by its weight above that of the fifth. The shares sum to the number of samples with a weight.
void gatherShares(std::span<const SampleValues> weights, std::span<double> shares);

}  // namespace ibr
