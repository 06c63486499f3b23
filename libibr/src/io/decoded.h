// SPDX-License-Identifier: Apache-2.0
// HEIC, AVIF, WebP and raw photographs are decoded by the program ibr-decode, whose libraries read complex files: a
// fault in them ends that process alone, within limits of memory and time. This is what the program writes: a header,
// then, if asked for, RGB rows of 8 bits, sRGB.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <type_traits>

#include "io/codec.h"

namespace ibr::io {

/// Both processes run on one machine and have one version: numbers are as in memory.
struct DecodedHeader {
  static constexpr std::array<char, 8> kMagic{'i', 'b', 'r', 'd', 'e', 'c', '1', 0};

  std::array<char, 8> magic = kMagic;
  std::uint32_t width = 0, height = 0;  // of the rows that follow or would follow
  std::uint32_t bitsPerChannel = 0;     // in the file
  std::uint32_t orientation = 1;        // EXIF, of the rows
  double exposureTime = 0, fNumber = 0, iso = 0, focalLength = 0, focalLength35 = 0;  // CaptureMetadata
  std::array<char, 64> maker{}, model{};                                              // CaptureMetadata, ended by 0
  std::array<char, 128> lens{};
};
static_assert(std::is_trivially_copyable_v<DecodedHeader> && sizeof(DecodedHeader) % 8 == 0);

DecodedHeader headerOf(const ImageFileInfo& info);

/// The picture's properties, checked: the sender may have been taken over by a hostile file. Throws
/// Error{invalidInput} with `name`.
ImageFileInfo infoOf(std::span<const std::byte> header, ImageFormat format, const std::string& name);

/// Format that ibr-decode reads; nullopt for all other files. Raw files that start as TIFF are told by their first
/// directory.
std::optional<ImageFormat> programFormat(Bytes file);

/// Name for messages: "HEIC".
const char* formatName(ImageFormat format);

/// As the decoders of codec.h. Run ibr-decode: IBR_DECODER in the environment, else beside this program, else in PATH.
/// Throw Error{io} if it cannot be run.
ImageFileInfo probeByProgram(Bytes file, const std::string& name);
Image8 readByProgram(Bytes file, const std::string& name, const ReadLimits& limits, ImageFileInfo& info);

}  // namespace ibr::io
