// SPDX-License-Identifier: Apache-2.0
// Pixels that nobody sees, for example outside a headset's lenses. Nothing is drawn, filled or interpolated there; the
// background shows.
#ifndef IBR_SHARED_HIDDEN_AREA_H
#define IBR_SHARED_HIDDEN_AREA_H

#include "shared/glsl.h"

IBR_SHARED_BEGIN

/// Alpha of hidden pixels in the canvas. Tier codes are 255, 191, 127 and 63 of 255; 0 is an empty pixel.
IBR_CONSTANT float kHiddenAlpha = 1.0f / 255.0f;

IBR_FUNCTION bool isHidden(float alpha) { return alpha > 0.5f / 255.0f && alpha < 1.5f / 255.0f; }

/// True if something was drawn at a pixel with this alpha.
IBR_FUNCTION bool isDrawn(float alpha) { return alpha > 1.5f / 255.0f; }

struct HiddenAreaConstants {
  vec4 toClip[2];  // by view: scale and offset of x, of y
};

IBR_SHARED_END

#endif
