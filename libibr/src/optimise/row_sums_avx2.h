// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "optimise/row_sums.h"

namespace ibr {

/// Eight pixels at once; null where the processor (or the compiler's target) has no AVX2.
const RunAdder* avx2RunAdder();

}  // namespace ibr
