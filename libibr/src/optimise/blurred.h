// SPDX-License-Identifier: Apache-2.0
// A picture's scale space, each level at full size, so that positions keep their meaning.
#pragma once

#include "optimise/texels.h"

namespace ibr {

/// Level `level` >= 1 from the one before, level 0 being the picture: the binomial (1 4 6 4 1)/16 with holes of
/// 2^(level−1) px either way (à trous, after Burt 1981). Level l has a standard deviation of √((4^l − 1)/3) px.
/// `threads` as in forEachInParallel.
Texels blurred(const Texels& before, int level, int threads);

}  // namespace ibr
