// SPDX-License-Identifier: Apache-2.0
// Agreement of the images of both eyes: differences beyond parallax cause binocular rivalry.
#pragma once

#include "ibr/camera.h"
#include "shared/draw/scene_renderer.h"

namespace ibr::app {

/// Statistics over the left eye's pixels of known depth whose point is visible to the right eye: within 2 % of the
/// depth that the right eye has there.
struct EyeAgreement {
  double seenByBoth = 0;      // share of all pixels; only these are compared
  double sameCell = NAN;      // share of compared pixels with the same cell and tier in both eyes
  double difference = NAN;    // mean absolute difference, 8-bit levels, bilinear in the right image
  double difference95 = NAN;  // 95 % quantile of the differences, 8-bit levels
};

/// Precondition: images with buffers, of pinholes, of the same plan (ranks mean the same in both).
EyeAgreement eyeAgreement(const SceneRenderer::Picture& left, const Camera& leftEye,
                          const SceneRenderer::Picture& right, const Camera& rightEye);

}  // namespace ibr::app
