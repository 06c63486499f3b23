// SPDX-License-Identifier: Apache-2.0
// One decoder per format, for a whole file in memory. `name` is the file's name in messages.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "ibr/image.h"
#include "io/image_file.h"

namespace ibr::io {

using Bytes = std::span<const std::byte>;

/// Called by every decoder between header and pixels: throws Error{invalidInput} if a size exceeds the limits.
void checkSize(const ImageFileInfo& info, const ReadLimits& limits, const std::string& name);

/// Appended to messages that refuse CMYK: the conversion to RGB depends on the printer.
inline constexpr const char* kCmykHint = ": CMYK is not supported; save the image as RGB in an image editor";

ImageFileInfo probeJpeg(Bytes file, const std::string& name);
ImageFileInfo probePng(Bytes file, const std::string& name);
ImageFileInfo probeTiff(Bytes file, const std::string& name);

/// 8-bit RGB as stored, without applying the orientation; `info` receives the result of the probe.
Image8 readJpeg(Bytes file, const std::string& name, const ReadLimits& limits, ImageFileInfo& info);
Image8 readPng(Bytes file, const std::string& name, const ReadLimits& limits, ImageFileInfo& info);
Image8 readTiff(Bytes file, const std::string& name, const ReadLimits& limits, ImageFileInfo& info);

/// Reads one channel of 16 bits.
Image<std::uint16_t> readPngGrey16(Bytes file, const std::string& name, const ReadLimits& limits);

/// Deterministic: the same image gives the same bytes.
std::vector<std::byte> encodeJpeg(const Image8& image, int quality, const std::string& name);
/// EXIF block of a JPEG file; empty if there is none.
std::vector<std::byte> exifOf(Bytes jpeg, const std::string& name);
/// Inserts an EXIF block and sets its orientation to 1. Leaves out a block that is too long for JPEG, of over 64 KiB.
std::vector<std::byte> withExif(std::vector<std::byte> jpeg, std::span<const std::byte> block);
std::vector<std::byte> encodePng(const Image8& image, const std::vector<ImageText>& texts, const std::string& name);

std::vector<ImageText> pngTexts(Bytes file, const std::string& name);

}  // namespace ibr::io
