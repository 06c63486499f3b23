// SPDX-License-Identifier: Apache-2.0
// Scale space of a photograph with every level at full size, so that positions keep their meaning.
#pragma once

#include "optimise/texels.h"

namespace ibr {

/// Level `level` >= 1 from the previous one; level 0 is the photograph. The filter is the binomial (1 4 6 4 1)/16 with
/// taps 2^(level−1) px apart (à trous, after Burt 1981). Level l has a standard deviation of √((4^l − 1)/3) px.
/// `threads` as in forEachInParallel.
Texels blurred(const Texels& before, int level, int threads);

}  // namespace ibr
