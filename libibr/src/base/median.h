// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace ibr {

/// The value in the middle of those that are not NaN, the greater of two; NaN where there is none.
double median(std::vector<double> values);

}  // namespace ibr
