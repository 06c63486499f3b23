// SPDX-License-Identifier: Apache-2.0
// A mesh's rigid motion (Correction) in the morph's formula: D = C·Σ λ_i R_i q_i + ρ·t, t as follows. Pure.
#pragma once

#include "ibr/renderer.h"

namespace ibr {

/// t of a corrected mesh for a camera at `eye`; `shift`: Σ λ_i c_i − p, which without a correction it is to the last
/// bit.
inline glm::dvec3 corrected(const Correction& correction, glm::dvec3 shift, glm::dvec3 eye) {
  if (correction == Correction{}) return shift;
  return correction.rotation * (shift + (eye - correction.pivot) + correction.shift) + (correction.pivot - eye);
}

}  // namespace ibr
