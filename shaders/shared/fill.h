// SPDX-License-Identifier: Apache-2.0
// Push–pull filling of what nothing was drawn on (Gortler, Grzeszczuk, Szeliski, Cohen, "The lumigraph", SIGGRAPH 1996,
// §3.4; the inpainting that [T] §2.7 looks forward to), for GLSL and C++.
//
//   pull: a coarser pixel is the mean of its up to four finer ones by weight; its weight is half their sum, at most 1
//   push: from the coarsest on, a finer pixel is mixed with the coarser level, interpolated, by its weight
#ifndef IBR_SHARED_FILL_H
#define IBR_SHARED_FILL_H

#include "shared/glsl.h"

IBR_SHARED_BEGIN

IBR_CONSTANT int kFillGroup = 8;  // threads of a workgroup, each way

/// Weight of a coarser pixel whose finer ones weigh `sum` together.
IBR_FUNCTION float pulledWeight(float sum) { return sum < 2.0f ? 0.5f * sum : 1.0f; }

IBR_SHARED_END

#endif
