// SPDX-License-Identifier: Apache-2.0
// Colour tables from histograms on the CPU ([T] §2.5.3, eqs 8–18): the reference implementation of
// shaders/render/colour_tables.comp, bit-identical, from the same functions of shared/colour_map.h.
#pragma once

#include <array>
#include <cstdint>

#include "shared/colour_map.h"

namespace ibr {

/// Number of pixels per level of one channel. Precondition: fewer than 2³² pixels in all.
using LevelHistogram = std::array<std::uint32_t, shader::kLevels>;

using LevelTable = std::array<std::uint8_t, shader::kLevels>;

LevelTable identityTable();

/// Returns f of eqs 10, 16 or 18 (`method`: shader::kMapNaive …) for one channel. `reference` and `modify` must count
/// the same pixels; otherwise levels without a counterpart go to 255. With fewer than `least` samples f is the
/// identity; f is blended in until there are 2·least samples. least < 2²³.
LevelTable levelTable(const LevelHistogram& reference, const LevelHistogram& modify, std::uint32_t method,
                      std::uint32_t least);

}  // namespace ibr
