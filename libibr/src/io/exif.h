// SPDX-License-Identifier: Apache-2.0
// EXIF metadata: orientation and exposure of a photograph; raw files, whose first bytes are a TIFF directory, too.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "ibr/capture.h"

namespace ibr::io {

struct Exif {
  int orientation = 1;    // 1 to 8; 1, "as stored", if absent
  bool adobeRgb = false;  // the colour space is Adobe RGB (1998): interoperability "R03"
  CaptureMetadata capture;
  std::optional<GeoLocation> location;
};

/// Reads an EXIF block that starts with its TIFF header ("II*" or "MM*"), or a TIFF file. Missing or damaged entries
/// are ignored: metadata never make a photograph unreadable.
Exif readExif(std::span<const std::byte> tiff);

struct ExifTag {
  std::uint16_t number = 0;
  bool preview = false;  // of the directory that describes the preview image
};
/// Tags of the first directory, the Exif directory and the preview's directory, in this order.
std::vector<ExifTag> exifTags(std::span<const std::byte> tiff);

/// An EXIF block of what is known, with orientation 1: the inverse of readExif.
std::vector<std::byte> exifBlock(const CaptureMetadata& capture, const std::optional<GeoLocation>& location = {});

/// True for a raw file that starts as a TIFF file: DNG, Canon CR2, and files whose first directory has a reduced image,
/// sensor values or a compression of camera makers.
bool isRawTiff(std::span<const std::byte> file);

/// Sets the orientation to 1, if there is one.
void resetOrientation(std::span<std::byte> tiff);

}  // namespace ibr::io
