// SPDX-License-Identifier: Apache-2.0
// Files that our own writer does not write, made with the same C libraries and by hand.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "ibr/error.h"
#include "ibr/image.h"

namespace ibr::test {

using Bytes = std::vector<std::uint8_t>;

/// Noise over a ramp: compresses badly, so that files are long and every part of them matters.
Image8 noisyPicture(int width, int height, int channels);

enum class JpegKind { baseline, progressive, manyScans, arithmetic, rgb, cmyk, ycck };
Bytes makeJpeg(const Image8& image, JpegKind kind);  // cmyk, ycck: 4 channels; rgb: not as YCbCr

/// PNG of any kind: `type` and `bits` as libpng has them, rows packed by the caller.
Bytes makePng(int width, int height, int type, int bits, const std::vector<Bytes>& rows, bool interlaced = false,
              const std::vector<std::uint8_t>& palette = {});

/// How a TIFF is laid out; without more words: one strip, in this machine's byte order.
struct TiffLayout {
  const char* mode = "w";  // of TIFFOpen: "wb" is big-endian, "w8" a BigTIFF
  bool planar = false;     // a picture a channel
  int tile = 0;            // side of tiles, a multiple of 16
  bool preview = false;    // said to be a smaller version of another picture
  Bytes profile = {};      // ICC
};
/// TIFF, uncompressed; `photometric` as libtiff has it; 8 or 16 bits a sample; alpha: the last sample is one.
void makeTiff(const std::filesystem::path& path, const Image<std::uint16_t>& image, int bits, int photometric,
              bool alpha, int orientation = 1, const TiffLayout& layout = {});

/// The same JPEG with an EXIF segment that holds `orientation`, or this block.
Bytes withExif(const Bytes& jpeg, int orientation);
Bytes withExifBlock(const Bytes& jpeg, const Bytes& block);
/// The same PNG with a chunk eXIf.
Bytes withPngExif(const Bytes& png, const Bytes& block);
/// The TIFF block of an EXIF segment.
Bytes exifBlock(int orientation, bool bigEndian);

/// An entry of an EXIF directory: a text, or whole numbers of `type` (3: short, 4: long, 5: rational, in pairs).
struct ExifEntry {
  int tag, type;
  std::vector<std::uint32_t> values;
  std::string text = {};
};
/// A TIFF block with these in its first directory and in the Exif IFD. The interoperability's index, if not empty,
/// stands in a directory of its own.
Bytes exifBlock(const std::vector<ExifEntry>& first, const std::vector<ExifEntry>& exif, bool bigEndian,
                const std::string& interoperability = {});

/// The same with an ICC profile.
Bytes withJpegProfile(const Bytes& jpeg, const Bytes& profile);
Bytes withPngProfile(const Bytes& png, const Bytes& profile);

/// The same file with another size in its header.
Bytes withJpegSize(Bytes jpeg, int width, int height);
Bytes withPngSize(Bytes png, int width, int height);

void writeBytes(const std::filesystem::path& path, const Bytes& bytes);
Bytes readBytes(const std::filesystem::path& path);

/// What `f` throws; fails the test where it throws nothing.
template <class F>
Error errorOf(F&& f);

}  // namespace ibr::test

#include <catch2/catch.hpp>

template <class F>
ibr::Error ibr::test::errorOf(F&& f) {
  try {
    f();
  } catch (const Error& e) {
    return e;
  }
  FAIL("nothing was thrown");
  throw;
}
