// SPDX-License-Identifier: Apache-2.0
// EXIF metadata: how a picture is turned, and how it was exposed.
#pragma once

#include <cstddef>
#include <span>

#include "ibr/capture.h"

namespace ibr::io {

struct Exif {
  int orientation = 1;    // 1 to 8; 1, "as stored", where there is none
  bool adobeRgb = false;  // colours are those of Adobe RGB (1998): interoperability "R03"
  CaptureFacts capture;
};

/// Of an EXIF block that begins with its TIFF header ("II*" or "MM*"), which a TIFF file does, too. What is missing or
/// damaged is as if it were not there: metadata never makes a photograph unreadable.
Exif readExif(std::span<const std::byte> tiff);

/// Makes its orientation 1, if it has one.
void setUpright(std::span<std::byte> tiff);

}  // namespace ibr::io
