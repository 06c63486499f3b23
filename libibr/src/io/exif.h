// SPDX-License-Identifier: Apache-2.0
// The one field of EXIF metadata that changes what a picture shows.
#pragma once

#include <cstddef>
#include <span>

namespace ibr::io {

/// The orientation (1 to 8) of an EXIF block that begins with its TIFF header ("II*" or "MM*"). 1, "as stored", where
/// there is none or the block is damaged: metadata never makes a photograph unreadable.
int exifOrientation(std::span<const std::byte> tiff);

}  // namespace ibr::io
