// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "optimise/row_sums.h"

namespace ibr {

/// Version with eight pixels at once; null if the processor or the compiler's target has no AVX2.
const RunAdder* avx2RunAdder();

}  // namespace ibr
