// SPDX-License-Identifier: Apache-2.0
// Push–pull filling of empty pixels (Gortler, Grzeszczuk, Szeliski, Cohen, "The lumigraph", SIGGRAPH 1996, §3.4; [T]
// §2.7 proposes inpainting as future work), for GLSL and C++.
//
//   pull: a coarser pixel is the weighted mean of its up to four finer pixels; its weight is half their sum, at most 1
//   push: from the coarsest level on, a finer pixel is blended with the interpolated coarser level, by its weight
#ifndef IBR_SHARED_FILL_H
#define IBR_SHARED_FILL_H

#include "shared/glsl.h"

IBR_SHARED_BEGIN

IBR_CONSTANT int kFillGroup = 8;  // threads of a workgroup, per dimension

/// Returns the weight of a coarser pixel, whose finer pixels have weights with this sum.
IBR_FUNCTION float pulledWeight(float sum) { return sum < 2.0f ? 0.5f * sum : 1.0f; }

IBR_SHARED_END

#endif
