// SPDX-License-Identifier: Apache-2.0
// Floating-point numbers at the limits of their range, for tests with extreme input.
#pragma once

#include <limits>

namespace ibr::test {

using Limits = std::numeric_limits<double>;

inline constexpr double kExtremes[] = {0.0,
                                       -0.0,
                                       Limits::denorm_min(),
                                       -Limits::denorm_min(),
                                       Limits::min(),
                                       Limits::max(),
                                       Limits::lowest(),
                                       Limits::infinity(),
                                       -Limits::infinity(),
                                       Limits::quiet_NaN()};

}  // namespace ibr::test
