// SPDX-License-Identifier: Apache-2.0
// Photographs whose numbers are not those of sRGB (IEC 61966-2-1): what an ICC profile (ISO 15076-1) says of them.
#pragma once

#include <cstddef>
#include <span>

#include "ibr/image.h"

namespace ibr::io {

/// Brings a picture of 3 channels to sRGB; colours that sRGB does not hold become the nearest of each channel. The
/// profile is of RGB, or of grey where all three channels are the same. A picture whose profile is damaged, of another
/// kind, or differs from sRGB by no more than 2 of 255 stays as it is, bit for bit. Thread-safe.
void toSrgb(Image8& picture, std::span<const std::byte> profile);

/// The same for Adobe RGB (1998), which cameras may also name without a profile (EXIF 2.32, interoperability "R03").
void adobeRgbToSrgb(Image8& picture);

}  // namespace ibr::io
