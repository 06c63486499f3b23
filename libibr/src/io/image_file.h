// SPDX-License-Identifier: Apache-2.0
// Photographs and images in files: JPEG (libjpeg-turbo), PNG (libpng), TIFF (libtiff), OpenEXR; by the program
// ibr-decode HEIC, AVIF, WebP and raw. Neither the runtime nor OpenCV is used. A truncated file is an error, never a
// half-grey image. All functions throw Error (io, invalidInput, unsupported) with the file's name. Thread-safe.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "ibr/capture.h"
#include "ibr/image.h"

namespace ibr {

enum class ImageFormat : std::uint8_t { jpeg, png, tiff, heic, avif, webp, raw };

struct ImageFileInfo {
  int width = 0, height = 0;  // as stored, before orientation; HEIC and AVIF: upright, as all their readers return them
  int channels = 0;
  int bitsPerChannel = 0;
  int orientation = 1;                     // EXIF, 1 to 8
  CaptureMetadata capture;                 // EXIF
  ImageFormat format = ImageFormat::jpeg;  // by content; file names can be wrong
};

struct ReadLimits {
  std::int64_t pixels = std::int64_t(1) << 28;
  int side = 1 << 16;
};

/// Reads the header only; makes all checks of readImage that need only the header.
ImageFileInfo probeImage(const std::filesystem::path& path);

/// Reads as 8-bit sRGB: grey and palette expanded, alpha dropped, 16 bits rounded to 8. Other colour spaces, by ICC
/// profile, code points (ITU-T H.273) or EXIF "R03", are converted, and high dynamic range is compressed; CMYK is
/// unsupported. Raw files are developed linearly, with the camera's white balance and without automatic brightness.
/// Applies the EXIF orientation only with applyOrientation: pose estimators may or may not have applied the
/// orientation.
Image8 readImage(const std::filesystem::path& path, bool applyOrientation = false, const ReadLimits& limits = {});

/// Reads a PNG with one channel of 16 bits, values as stored.
Image<std::uint16_t> readGrey16(const std::filesystem::path& path, const ReadLimits& limits = {});

/// 1, 3 or 4 channels; the format follows the extension: .png (lossless), .jpg/.jpeg (3 or 1 channels, `quality`).
void writeImage(const std::filesystem::path& path, const Image8& image, int quality = 92);

/// Applies an EXIF orientation, 1 to 8, to an image as stored.
Image8 upright(const Image8& stored, int orientation);

/// Writes a JPEG with EXIF of the metadata and the location.
void writePhotograph(const std::filesystem::path& path, const Image8& image, int quality,
                     const CaptureMetadata& capture, const std::optional<GeoLocation>& location);

/// Writes the photograph in `from` as a JPEG, whatever the file's name; upright, or as stored. EXIF is kept, with
/// orientation 1: all of a JPEG's, the CaptureMetadata of other formats.
void writeJpegCopy(const std::filesystem::path& from, const std::filesystem::path& to, bool upright);

/// A text inside an image. `key`: 1 to 79 printable ASCII characters, no leading, trailing or double spaces; `text`:
/// UTF-8 without a zero byte.
struct ImageText {
  std::string key, text;

  bool operator==(const ImageText&) const = default;
};

/// Writes a PNG file with texts before its pixels (PNG 1.2 §4.2.3: tEXt if ASCII, else iTXt; not compressed).
/// Deterministic: the same image and texts give the same bytes.
void writeImage(const std::filesystem::path& path, const Image8& image, const std::vector<ImageText>& texts);

/// Reads the texts before a PNG's pixels (tEXt, zTXt, iTXt), in order, as UTF-8. Skips texts with a wrong checksum.
/// Other formats have none.
std::vector<ImageText> readImageTexts(const std::filesystem::path& path);

/// Name of an image format that is recognised but not supported, for messages: "GIF"; "" for all other files. Throws
/// Error{io}.
std::string unsupportedImageFormat(const std::filesystem::path& path);

/// True if a file starts as one of an ImageFormat; false if it cannot be read. Never throws.
bool isImageFile(const std::filesystem::path& path) noexcept;

}  // namespace ibr
