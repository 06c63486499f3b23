// SPDX-License-Identifier: Apache-2.0
// Colours that a file describes by the code points of Recommendation ITU-T H.273 instead of an ICC profile.
#pragma once

#include <cstdint>

#include "ibr/image.h"

namespace ibr::io {

/// Table 2 (colour primaries) and table 3 (transfer characteristics) of H.273.
struct ColourCode {
  int primaries = 1;  // BT.709 and sRGB
  int transfer = 13;  // sRGB
};

/// The code points of pixels that are stored as displayed by sRGB: BT.709 primaries, and a transfer that video decoders
/// show unchanged.
bool isSrgb(ColourCode code);

/// 8-bit sRGB of RGB values over the whole range of 16 bits. Out-of-gamut colours are clamped per channel. Light of HDR
/// transfers (PQ, HLG) is relative to diffuse white of 203 cd/m² (Report ITU-R BT.2408), and compressed above 0.7 of
/// it, so that 1000 cd/m² become white. Throws Error{unsupported} that names an unknown code point.
Image8 toSrgb(const Image<std::uint16_t>& picture, ColourCode code);

}  // namespace ibr::io
