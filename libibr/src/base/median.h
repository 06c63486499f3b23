// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace ibr {

/// Upper median of the values that are not NaN; NaN if there are none.
double median(std::vector<double> values);

}  // namespace ibr
