// SPDX-License-Identifier: Apache-2.0
// Pixels that nobody sees, such as a headset's lenses leave out: nothing is drawn, filled or interpolated there, and the
// background shows.
#ifndef IBR_SHARED_HIDDEN_AREA_H
#define IBR_SHARED_HIDDEN_AREA_H

#include "shared/glsl.h"

IBR_SHARED_BEGIN

/// Their alpha in the canvas, where tier codes are 255, 191, 127 and 63 of 255, and 0 is what nothing shows.
IBR_CONSTANT float kHiddenAlpha = 1.0f / 255.0f;

IBR_FUNCTION bool isHidden(float alpha) { return alpha > 0.5f / 255.0f && alpha < 1.5f / 255.0f; }

/// Whether something was drawn there.
IBR_FUNCTION bool isDrawn(float alpha) { return alpha > 1.5f / 255.0f; }

struct HiddenAreaConstants {
  vec4 toClip[2];  // by view: scale and offset of x, of y
};

IBR_SHARED_END

#endif
