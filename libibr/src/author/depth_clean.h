// SPDX-License-Identifier: Apache-2.0
// What a matcher's depth map needs before it can be believed: outliers smoothed away, speckles replaced.
#pragma once

#include "ibr/image.h"

namespace ibr {

/// In place: median of 5×5; connected regions (neighbours differ by at most `step`) of fewer than `least` pixels are
/// filled from the nearest remaining pixel to the left or right in their row, whichever is smaller: farther away, when
/// the values are inverse depths. One channel.
void cleanDepth(ImageF& inverseDepth, float step, int least);

}  // namespace ibr
