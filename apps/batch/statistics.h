// SPDX-License-Identifier: Apache-2.0
// Of repeated measurements.
#pragma once

#include <algorithm>
#include <numeric>
#include <vector>

namespace ibr::app {

/// Of at least one value; q of 0 to 1.
inline double quantile(std::vector<double> values, double q) {
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, std::size_t(q * double(values.size())))];
}

inline double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
}

}  // namespace ibr::app
