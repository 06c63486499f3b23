// SPDX-License-Identifier: Apache-2.0
// Image files of kinds that the library does not write, made with the same C libraries and by hand.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "ibr/error.h"
#include "ibr/image.h"

namespace ibr::test {

using Bytes = std::vector<std::uint8_t>;

/// Noise over a ramp. Compresses badly, so files are long and damage anywhere has an effect.
Image8 noisyPicture(int width, int height, int channels);

enum class JpegKind { baseline, progressive, manyScans, arithmetic, rgb, cmyk, ycck };
Bytes makeJpeg(const Image8& image, JpegKind kind);  // cmyk, ycck: 4 channels; rgb: not converted to YCbCr

/// Writes a PNG of any kind: `type` and `bits` as in libpng; the caller packs the rows.
Bytes makePng(int width, int height, int type, int bits, const std::vector<Bytes>& rows, bool interlaced = false,
              const std::vector<std::uint8_t>& palette = {});

/// Layout of a TIFF. Default: one strip, native byte order.
struct TiffLayout {
  const char* mode = "w";  // of TIFFOpen: "wb" is big-endian, "w8" BigTIFF
  bool planar = false;     // one plane for each channel
  int tile = 0;            // side of tiles, a multiple of 16
  bool preview = false;    // marked as a reduced version of another picture
  Bytes profile = {};      // ICC
};
/// Writes an uncompressed TIFF; `photometric` as in libtiff; 8 or 16 bits per sample; alpha: the last channel is alpha.
void makeTiff(const std::filesystem::path& path, const Image<std::uint16_t>& image, int bits, int photometric,
              bool alpha, int orientation = 1, const TiffLayout& layout = {});

/// Return the JPEG with an EXIF segment that holds `orientation`, or with the given block.
Bytes withExif(const Bytes& jpeg, int orientation);
Bytes withExifBlock(const Bytes& jpeg, const Bytes& block);
/// Returns the PNG with an eXIf chunk.
Bytes withPngExif(const Bytes& png, const Bytes& block);
/// Returns the TIFF block of an EXIF segment.
Bytes exifBlock(int orientation, bool bigEndian);

/// Entry of an EXIF directory: text, or integers of `type` (3: short, 4: long, 5: rational, in pairs).
struct ExifEntry {
  int tag, type;
  std::vector<std::uint32_t> values;
  std::string text = {};
};
/// Returns a TIFF block with these entries in the first directory and in the Exif IFD. The interoperability index,
/// if not empty, has its own directory.
Bytes exifBlock(const std::vector<ExifEntry>& first, const std::vector<ExifEntry>& exif, bool bigEndian,
                const std::string& interoperability = {});

/// Return the file with an ICC profile.
Bytes withJpegProfile(const Bytes& jpeg, const Bytes& profile);
Bytes withPngProfile(const Bytes& png, const Bytes& profile);

/// Return the file with another size in its header.
Bytes withJpegSize(Bytes jpeg, int width, int height);
Bytes withPngSize(Bytes png, int width, int height);

void writeBytes(const std::filesystem::path& path, const Bytes& bytes);
Bytes readBytes(const std::filesystem::path& path);

/// Returns the Error that `f` throws; fails the test if `f` throws none.
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
