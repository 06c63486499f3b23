// SPDX-License-Identifier: Apache-2.0
// Definitions of the enhanced correlation coefficient (ECC).
#pragma once

#include <cstdint>

namespace ibr {

enum class EccDefinition : std::uint8_t {
  channels,      // a separate mean for each channel and target, with a variance floor
  concatenated,  // one mean over all channels and targets, [T] eqs 1–3
};

}  // namespace ibr
