// SPDX-License-Identifier: Apache-2.0
// One decoder a format, over a whole file in memory. `name` is what messages call the file.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "ibr/image.h"
#include "io/image_file.h"

namespace ibr::io {

using Bytes = std::span<const std::byte>;

/// What every decoder does between header and pixels: throws Error{invalidInput} where a size is over the limits.
void checkSize(const ImageFileInfo& info, const ReadLimits& limits, const std::string& name);

/// Behind a sentence that refuses inks: how much light they leave, no two printers agree on.
inline constexpr const char* kCmykAdvice =
    ": it is a CMYK picture, made for print. Save it as RGB with the program that made it";

ImageFileInfo probeJpeg(Bytes file, const std::string& name);
ImageFileInfo probePng(Bytes file, const std::string& name);
ImageFileInfo probeTiff(Bytes file, const std::string& name);

/// 8-bit RGB as stored, orientation not applied; `info` receives what the probe would say.
Image8 readJpeg(Bytes file, const std::string& name, const ReadLimits& limits, ImageFileInfo& info);
Image8 readPng(Bytes file, const std::string& name, const ReadLimits& limits, ImageFileInfo& info);
Image8 readTiff(Bytes file, const std::string& name, const ReadLimits& limits, ImageFileInfo& info);

/// One channel of 16 bits.
Image<std::uint16_t> readPngGrey16(Bytes file, const std::string& name, const ReadLimits& limits);

/// The same picture gives the same bytes.
std::vector<std::byte> encodeJpeg(const Image8& image, int quality, const std::string& name);
/// `jpeg` with the EXIF block that the JPEG file `original` has, if it has one; in it, its orientation is 1.
std::vector<std::byte> withExifOf(Bytes original, std::vector<std::byte> jpeg, const std::string& name);
std::vector<std::byte> encodePng(const Image8& image, const std::vector<ImageText>& texts, const std::string& name);

std::vector<ImageText> pngTexts(Bytes file, const std::string& name);

}  // namespace ibr::io
