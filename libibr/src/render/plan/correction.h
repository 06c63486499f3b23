// SPDX-License-Identifier: Apache-2.0
// Applies a mesh's rigid motion (Correction) in the morph's formula D = C·Σ λ_i R_i q_i + ρ·t. Pure.
#pragma once

#include "ibr/frame_plan.h"

namespace ibr {

/// Returns t of a corrected mesh for a camera at `eye`. `shift`: Σ λ_i c_i − p, which is returned bit-identical if
/// there is no correction.
inline glm::dvec3 corrected(const Correction& correction, glm::dvec3 shift, glm::dvec3 eye) {
  if (correction == Correction{}) return shift;
  return correction.rotation * (shift + (eye - correction.pivot) + correction.shift) + (correction.pivot - eye);
}

}  // namespace ibr
