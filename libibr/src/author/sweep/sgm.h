// SPDX-License-Identifier: Apache-2.0
// Semi-global matching (Hirschmüller, "Stereo processing by semiglobal matching and mutual information", PAMI 2008).
//
//   L_r(p, l) = C(p, l) + min(L_r(p−r, l), L_r(p−r, l±1) + P1, min_k L_r(p−r, k) + P2) − min_k L_r(p−r, k)
//   level(p) = argmin_l Σ over 8 directions r of L_r(p, l), refined by a parabola
//   P2 falls where the guide has an edge, and never below 3·P1
//
// Near the volume's slanted planes, at levels l within kPlaneReach of the plane's level, one more choice is L_r(p−r, l
// − change of the plane's level): following the plane costs nothing (Scharstein, Taniai & Sinha, "Semi-global stereo
// matching with surface orientation priors", 3DV 2017).
#pragma once

#include "author/sweep/plane_sweep.h"

namespace ibr {

/// One channel each.
struct SemiGlobalMatch {
  ImageF level;        // of least cost, fractional
  ImageF firstExcess;  // cost of level 0 minus the least cost, mean of the directions
};
SemiGlobalMatch semiGlobalMatch(const CostVolume& volume);

}  // namespace ibr
