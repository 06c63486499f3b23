// SPDX-License-Identifier: Apache-2.0
// Converts photographs to sRGB (IEC 61966-2-1) from the colour space of an ICC profile (ISO 15076-1).
#pragma once

#include <cstddef>
#include <span>

#include "ibr/image.h"

namespace ibr::io {

/// Converts an image of 3 channels to sRGB; out-of-gamut colours are clamped per channel. The profile is for RGB, or
/// for grey if all three channels are equal. The image stays unchanged, bit for bit, if the profile is damaged, of
/// another kind, or within 2 levels of sRGB. Thread-safe.
void toSrgb(Image8& picture, std::span<const std::byte> profile);

/// Converts from Adobe RGB (1998), which cameras may state without a profile (EXIF 2.32, interoperability "R03").
void adobeRgbToSrgb(Image8& picture);

}  // namespace ibr::io
