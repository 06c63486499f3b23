// SPDX-License-Identifier: Apache-2.0
// Hole filling by pull and push (shaders/shared/fill.h), in double precision.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "shared/fill.h"

namespace ibr::reference {

/// A level of the image pyramid, row by row: values, and the known share of each, 0 to 1. `Value` supports addition and
/// scaling by a double.
template <class Value>
struct FillLevel {
  FillLevel(int w, int h)
      : width(w),
        height(h),
        value(std::size_t(w) * std::size_t(h), Value(0)),
        weight(std::size_t(w) * std::size_t(h), 0.0) {}
  std::size_t index(int x, int y) const { return std::size_t(y) * std::size_t(width) + std::size_t(x); }

  int width, height;
  std::vector<Value> value;
  std::vector<double> weight;
};

template <class Value>
FillLevel<Value> pulled(const FillLevel<Value>& fine) {
  FillLevel<Value> coarse((fine.width + 1) / 2, (fine.height + 1) / 2);
  for (int y = 0; y < fine.height; ++y)
    for (int x = 0; x < fine.width; ++x) {
      const std::size_t from = fine.index(x, y), to = coarse.index(x / 2, y / 2);
      coarse.value[to] += fine.weight[from] * fine.value[from];
      coarse.weight[to] += fine.weight[from];
    }
  for (std::size_t at = 0; at < coarse.value.size(); ++at)
    if (coarse.weight[at] > 0) {
      coarse.value[at] *= 1 / coarse.weight[at];
      coarse.weight[at] = double(shader::pulledWeight(float(coarse.weight[at])));
    }
  return coarse;
}

template <class Value>
void push(const FillLevel<Value>& coarse, FillLevel<Value>& fine) {
  const auto mix = [](const Value& a, const Value& b, double t) { return (1 - t) * a + t * b; };
  for (int y = 0; y < fine.height; ++y)
    for (int x = 0; x < fine.width; ++x) {
      const std::size_t at = fine.index(x, y);
      if (fine.weight[at] >= 1) continue;
      const double u = std::clamp((x + 0.5) / 2 - 0.5, 0.0, coarse.width - 1.0),
                   v = std::clamp((y + 0.5) / 2 - 0.5, 0.0, coarse.height - 1.0);
      const int left = int(u), top = int(v), right = std::min(left + 1, coarse.width - 1),
                below = std::min(top + 1, coarse.height - 1);
      const auto across = [&](int row) {
        return mix(coarse.value[coarse.index(left, row)], coarse.value[coarse.index(right, row)], u - left);
      };
      fine.value[at] = mix(mix(across(top), across(below), v - top), fine.value[at], fine.weight[at]);
    }
}

/// Fills unknown values from around them. Returns false, without a change, if all or no values are known.
template <class Value>
bool fill(FillLevel<Value>& finest) {
  const auto isKnown = [](double weight) { return weight > 0; };
  if (std::ranges::all_of(finest.weight, isKnown) || std::ranges::none_of(finest.weight, isKnown)) return false;
  std::vector<FillLevel<Value>> coarser{pulled(finest)};
  while (coarser.back().width > 1 || coarser.back().height > 1) coarser.push_back(pulled(coarser.back()));
  for (std::size_t l = coarser.size() - 1; l-- > 0;) push(coarser[l + 1], coarser[l]);
  push(coarser.front(), finest);
  return true;
}

}  // namespace ibr::reference
