// SPDX-License-Identifier: Apache-2.0
#include "base/median.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace ibr {

double median(std::vector<double> values) {
  std::erase_if(values, [](double v) { return std::isnan(v); });
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace ibr
