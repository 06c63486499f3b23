// SPDX-License-Identifier: Apache-2.0
#include "shared/report/plot_axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace ibr::app {
namespace {

constexpr double kMargin = 0.08;  // share of the values' range, on each side
constexpr int kMaxTicks = 7;

// Ticks at 1, 2 and 5 times powers of ten. If these are few, all digits; if too many, powers of ten alone, thinned
// to kMaxTicks.
std::vector<double> logTicks(double low, double high) {
  std::vector<double> all, fine, coarse;
  for (int n = int(std::floor(std::log10(low))); n <= int(std::ceil(std::log10(high))); ++n)
    for (int digit = 1; digit < 10; ++digit) {
      const double tick = digit * std::pow(10.0, n);
      if (tick < low || tick > high) continue;
      all.push_back(tick);
      if (digit == 1 || digit == 2 || digit == 5) fine.push_back(tick);
      if (digit == 1) coarse.push_back(tick);
    }
  if (fine.size() < 4 && int(all.size()) <= kMaxTicks) return all;
  if (int(fine.size()) <= kMaxTicks) return fine;
  const std::size_t each = (coarse.size() + kMaxTicks - 1) / kMaxTicks;
  std::vector<double> some;
  for (std::size_t i = 0; i < coarse.size(); i += each) some.push_back(coarse[i]);
  return some;
}

}  // namespace

RoundTicks roundTicks(double low, double high, int most) {
  int power = int(std::floor(std::log10((high - low) / most)));
  for (;; ++power)
    for (const int digit : {1, 2, 5}) {
      // Divides by a whole power of ten, which gives the double nearest to a decimal such as 0.3.
      const double ten = std::pow(10.0, std::abs(power)), step = power < 0 ? digit / ten : digit * ten;
      const auto first = std::ceil(low / step), last = std::floor(high / step);
      if (last - first + 1 > most) continue;
      RoundTicks ticks{{}, std::max(0, -power)};
      for (double k = first; k <= last; ++k) ticks.values.push_back(power < 0 ? k * digit / ten : k * digit * ten);
      return ticks;
    }
}

double PlotAxis::share(double value) const {
  if (logarithmic) return std::log(value / low) / std::log(high / low);
  return (value - low) / (high - low);
}

PlotAxis axisOver(const std::vector<double>& values, bool logarithmic) {
  PlotAxis axis{0, 1, logarithmic, {}, {}};
  std::vector<double> shown;
  for (const double value : values)
    if (std::isfinite(value) && (!logarithmic || value > 0)) shown.push_back(logarithmic ? std::log10(value) : value);
  if (!shown.empty()) {
    const auto [low, high] = std::ranges::minmax(shown);
    const double range = high - low, least = logarithmic ? 0.1 : std::max(1e-3, 1e-3 * std::abs(high));
    const double margin = std::max(kMargin * range, (least - range) / 2);
    axis.low = low - margin;
    axis.high = high + margin;
  }
  if (logarithmic) {
    axis.low = std::pow(10.0, axis.low);
    axis.high = std::pow(10.0, axis.high);
    axis.ticks = logTicks(axis.low, axis.high);
    for (const double tick : axis.ticks) axis.labels.push_back(fmt::format("{:g}", tick));
  }
  if (axis.ticks.size() < 2) {
    const RoundTicks ticks = roundTicks(axis.low, axis.high, kMaxTicks);
    axis.ticks = ticks.values;
    axis.labels.clear();
    for (const double tick : axis.ticks) axis.labels.push_back(fmt::format("{:.{}f}", tick, ticks.decimals));
  }
  return axis;
}

}  // namespace ibr::app
