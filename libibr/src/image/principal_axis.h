// SPDX-License-Identifier: Apache-2.0
// Ends of a block's colours along their principal axis.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace ibr {

template <std::size_t N>
struct AxisEnds {
  std::array<double, N> low, high;  // may lie outside 0 to 255
};

/// Ends of the first N channels. Power iteration finds the axis, the covariance's largest eigenvector.
template <std::size_t N>
AxisEnds<N> principalEnds(const std::array<std::array<std::uint8_t, 4>, 16>& pixels) noexcept {
  std::array<double, N> mean{};
  for (const auto& pixel : pixels)
    for (std::size_t c = 0; c < N; ++c) mean[c] += pixel[c] / 16.0;
  std::array<std::array<double, N>, N> covariance{};
  for (const auto& pixel : pixels)
    for (std::size_t i = 0; i < N; ++i)
      for (std::size_t j = 0; j < N; ++j) covariance[i][j] += (pixel[i] - mean[i]) * (pixel[j] - mean[j]);
  std::size_t widest = 0;
  for (std::size_t c = 1; c < N; ++c)
    if (covariance[c][c] > covariance[widest][widest]) widest = c;

  std::array<double, N> axis = covariance[widest];  // orthogonal to the eigenvector only by chance
  const auto normalise = [&] {
    double square = 0;
    for (const double v : axis) square += v * v;
    if (square == 0) axis[0] = square = 1;
    for (double& v : axis) v /= std::sqrt(square);
  };
  normalise();
  constexpr int kIterations = 8;
  for (int i = 0; i < kIterations; ++i) {
    std::array<double, N> next{};
    for (std::size_t r = 0; r < N; ++r)
      for (std::size_t c = 0; c < N; ++c) next[r] += covariance[r][c] * axis[c];
    axis = next;
    normalise();
  }

  double low = 0, high = 0;
  for (const auto& pixel : pixels) {
    double along = 0;
    for (std::size_t c = 0; c < N; ++c) along += (pixel[c] - mean[c]) * axis[c];
    low = std::min(low, along);
    high = std::max(high, along);
  }
  AxisEnds<N> ends;
  for (std::size_t c = 0; c < N; ++c) {
    ends.low[c] = mean[c] + low * axis[c];
    ends.high[c] = mean[c] + high * axis[c];
  }
  return ends;
}

}  // namespace ibr
