// SPDX-License-Identifier: Apache-2.0
// Depth of regions without texture. Nothing in them speaks for any depth, so that smoothness gives them that of what
// stands before them: the sky takes the depth of roofs.
//
//   region: connected pixels where the picture does not change and infinity costs no more than ε above the best level
//   its border, just outside: on one plane, and it is a surface that the border belongs to, and stays as it is; else
//   what is on its border stands before it, and it is at least as far as the farthest of that: at infinity, if that is
//   all but there
#pragma once

#include "author/plane_sweep.h"

namespace ibr {

/// `level` (1 channel, of the volume's size): levels of the sweep, made smaller in place.
void settleTextureless(ImageF& level, const CostVolume& volume);

}  // namespace ibr
