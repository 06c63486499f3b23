// SPDX-License-Identifier: Apache-2.0
// Axes of plots: ranges and round ticks.
#pragma once

#include <string>
#include <vector>

namespace ibr::app {

/// Ascending multiples of 1, 2 or 5 times a power of ten: the smallest such step with at most `most` ticks from `low`
/// to `high`. Preconditions: finite, low < high, most >= 2.
struct RoundTicks {
  std::vector<double> values;
  int decimals = 0;  // decimals that distinguish the values
};
RoundTicks roundTicks(double low, double high, int most);

struct PlotAxis {
  double low = 0, high = 1;
  bool logarithmic = false;
  std::vector<double> ticks;
  std::vector<std::string> labels;  // of the ticks

  /// Returns the position of a value: 0 at low, 1 at high. Precondition: positive on a logarithmic axis.
  double share(double value) const;
};

/// Returns an axis that covers all drawable `values` (finite; positive on a logarithmic axis) with a margin. Never
/// empty: extends around a single value; 0 to 1 (1 to 10) if there is none.
PlotAxis axisOver(const std::vector<double>& values, bool logarithmic);

}  // namespace ibr::app
