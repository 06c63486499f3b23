// SPDX-License-Identifier: Apache-2.0
// Colour tables from histograms on the CPU ([T] §2.5.3, eqs 8–18): what shaders/render/colour_tables.comp computes, bit
// for bit, from the same functions of shared/colour_map.h.
#pragma once

#include <array>
#include <cstdint>

#include "shared/colour_map.h"

namespace ibr {

/// Pixels by level of one channel. Precondition: fewer than 2³² pixels in all.
using LevelHistogram = std::array<std::uint32_t, shader::kLevels>;

using LevelTable = std::array<std::uint8_t, shader::kLevels>;

LevelTable identityTable();

/// f of eqs 10, 16 or 18 (`method`: shader::kMapNaive …) for one channel. `reference` and `modify` are of the same
/// pixels; were they not, levels that find no counterpart would go to 255. With fewer than `least` samples f is the
/// identity; it fades to f until there are 2·least. least < 2²³.
LevelTable levelTable(const LevelHistogram& reference, const LevelHistogram& modify, std::uint32_t method,
                      std::uint32_t least);

}  // namespace ibr
