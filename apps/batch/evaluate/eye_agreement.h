// SPDX-License-Identifier: Apache-2.0
// Whether both eyes see the same: what differs between them beyond parallax rivals (NUMERICS §5.2).
#pragma once

#include "ibr/camera.h"
#include "shared/draw/scene_renderer.h"

namespace ibr::app {

/// Of the left eye's pixels whose depth is known and whose place the right eye sees as well: within 2 % of the depth
/// that it has there.
struct EyeAgreement {
  double seenByBoth = 0;      // share of all pixels; the others are not compared
  double sameCell = NAN;      // share of what is compared that one cell shows both eyes
  double difference = NAN;    // mean absolute difference, levels, bilinear in the right eye's picture
  double difference95 = NAN;  // 95 % of what is compared differ by less
};

/// Precondition: pictures with buffers, of pinholes, of one plan (ranks mean the same in both).
EyeAgreement eyeAgreement(const SceneRenderer::Picture& left, const Camera& leftEye,
                          const SceneRenderer::Picture& right, const Camera& rightEye);

}  // namespace ibr::app
