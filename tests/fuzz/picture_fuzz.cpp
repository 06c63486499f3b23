// SPDX-License-Identifier: Apache-2.0
// Fuzz target for JPEG, PNG and TIFF with EXIF, profiles and texts; read as photographs, masks and OpenEXR.
#include <tiffio.h>

#include "fuzz_target.h"
#include "io/exr.h"
#include "io/image_file.h"

using namespace ibr;
using namespace ibr::test;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const TemporaryFolder folder;
  const std::filesystem::path file = folder / "a";
  put(file, textOf(data, size));
  const ReadLimits limits{.pixels = 1 << 20};
  answers([&] { probeImage(file); });
  answers([&] { readImageTexts(file); });
  answers([&] { readGrey16(file, limits); });
  answers([&] { readExr(file); });
  return answers([&] {
    const Image8 picture = readImage(file, true, limits);
    demand(picture.width > 0 && picture.height > 0 && picture.channels == 3);
  });
}

namespace {

/// Values that compress badly, so that every part of a file matters.
Image8 noise(int channels) {
  Image8 picture(17, 9, channels);
  std::uint32_t state = 1;
  for (std::uint8_t& value : picture.values) value = std::uint8_t((state = state * 1664525 + 1013904223) >> 24);
  return picture;
}

/// Inserts an EXIF orientation after the first two bytes of a JPEG.
std::string withExif(std::string jpeg) {
  const std::string block(
      "\xff\xe1\0\x22"
      "Exif\0\0II*\0\x08\0\0\0\1\0\x12\1\3\0\1\0\0\0\6\0\0\0\0\0\0\0",
      36);
  return jpeg.insert(2, block);
}

void writeTiff(const std::filesystem::path& file, const char* mode, int compression) {
  TIFF* const tiff = TIFFOpen(file.c_str(), mode);
  Image8 picture = noise(3);
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, picture.width);
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, picture.height);
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 3);
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 8);
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_RGB);
  TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  TIFFSetField(tiff, TIFFTAG_COMPRESSION, compression);
  TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, 4);
  for (int y = 0; y < picture.height; ++y) TIFFWriteScanline(tiff, picture.pixel(0, y).data(), std::uint32_t(y));
  TIFFClose(tiff);
}

}  // namespace

std::vector<std::string> ibr::test::seeds() {
  const TemporaryFolder folder;
  writeImage(folder / "a.jpg", noise(3));
  writeImage(folder / "b.jpg", noise(1));
  writeImage(folder / "a.png", noise(4));
  writeImage(folder / "b.png", noise(1));
  writeTiff(folder / "a.tif", "w", COMPRESSION_NONE);
  writeTiff(folder / "b.tif", "wb", COMPRESSION_LZW);
  const ExrChannel depth{"Z", ImageF(7, 5, 1)};
  writeExr(folder / "a.exr", {&depth, 1});
  std::vector<std::string> all{withExif(readTextFile(folder / "a.jpg"))};
  for (const char* name : {"b.jpg", "a.png", "b.png", "a.tif", "b.tif", "a.exr"})
    all.push_back(readTextFile(folder / name));
  return all;
}
