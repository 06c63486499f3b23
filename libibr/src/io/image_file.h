// SPDX-License-Identifier: Apache-2.0
// Photographs and pictures in files: JPEG (libjpeg-turbo), PNG (libpng), TIFF (libtiff), OpenEXR. Neither the runtime
// nor OpenCV. A truncated file is an error, never a half-grey picture. All throw Error (io, invalidInput, unsupported)
// naming the file. Thread-safe.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "ibr/capture.h"
#include "ibr/image.h"

namespace ibr {

enum class ImageFormat : std::uint8_t { jpeg, png, tiff };

struct ImageFileInfo {
  int width = 0, height = 0;  // as stored, before orientation
  int channels = 0;
  int bitsPerChannel = 0;
  int orientation = 1;                     // EXIF, 1 to 8
  CaptureFacts capture;                    // EXIF
  ImageFormat format = ImageFormat::jpeg;  // by content: names lie
};

struct ReadLimits {
  std::int64_t pixels = std::int64_t(1) << 28;
  int side = 1 << 16;
};

/// Reads the header only; refuses what readImage refuses by it.
ImageFileInfo probeImage(const std::filesystem::path& path);

/// Reads as 8-bit sRGB: grey and palette expanded, alpha dropped, 16 bits rounded to 8; what an ICC profile, or the
/// word "R03" in EXIF, says to be of another colour space is converted; CMYK is unsupported. The EXIF orientation is
/// applied only where asked: a pose estimator may or may not have applied it.
Image8 readImage(const std::filesystem::path& path, bool applyOrientation = false, const ReadLimits& limits = {});

/// Reads a PNG with one channel of 16 bits, values as stored.
Image<std::uint16_t> readGrey16(const std::filesystem::path& path, const ReadLimits& limits = {});

/// 1, 3 or 4 channels; the format follows the extension: .png (lossless), .jpg/.jpeg (3 or 1 channels, `quality`).
void writeImage(const std::filesystem::path& path, const Image8& image, int quality = 92);

/// A picture as it is stored, turned as its EXIF orientation, 1 to 8, says.
Image8 upright(const Image8& stored, int orientation);

/// Writes the photograph in `from` turned upright: a JPEG whatever the file is called, with all that EXIF says of a
/// JPEG but its orientation, which is 1.
void writeUpright(const std::filesystem::path& from, const std::filesystem::path& to);

/// A text inside a picture. `key`: 1 to 79 printable ASCII characters, no space at either end nor two in a row; `text`:
/// UTF-8 without a zero byte.
struct ImageText {
  std::string key, text;

  bool operator==(const ImageText&) const = default;
};

/// A PNG file with texts before its pixels (PNG 1.2 §4.2.3: tEXt where all is ASCII, else iTXt; not compressed). The
/// same picture and texts give the same bytes.
void writeImage(const std::filesystem::path& path, const Image8& image, const std::vector<ImageText>& texts);

/// Texts that stand before a PNG's pixels, in their order and as UTF-8 (tEXt, zTXt, iTXt); those whose checksum is
/// wrong are left out. Of another format: none.
std::vector<ImageText> readImageTexts(const std::filesystem::path& path);

/// What a file is that begins as pictures do that are not read here, for people: "HEIC"; "" for all others. Throws
/// Error{io}.
std::string foreignImageFormat(const std::filesystem::path& path);

/// Whether a file begins as a JPEG, PNG or TIFF file does; false where it cannot be read. Never throws.
bool isImageFile(const std::filesystem::path& path) noexcept;

}  // namespace ibr
