// SPDX-License-Identifier: Apache-2.0
// Which enhanced correlation coefficient (ECC) is meant.
#pragma once

#include <cstdint>

namespace ibr {

enum class EccDefinition : std::uint8_t {
  channels,      // a mean a channel and target, with a variance floor
  concatenated,  // [T] eqs 1–3: one mean over all channels and targets
};

}  // namespace ibr
