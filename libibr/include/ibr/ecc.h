// SPDX-License-Identifier: Apache-2.0
// Definitions of the enhanced correlation coefficient (ECC).
#pragma once

#include <cstdint>

namespace ibr {

/// Definition of the ECC of a point's triangles, between one picture and all others.
enum class EccDefinition : std::uint8_t {
  channels,      // a separate mean for each channel and target, with a variance floor
  concatenated,  // one mean over all channels and targets, [T] eqs 1–3
};

}  // namespace ibr
