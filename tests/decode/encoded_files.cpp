// SPDX-License-Identifier: Apache-2.0
#include "encoded_files.h"

#include <lcms2.h>
#include <tiffio.h>

#include <algorithm>
#include <cmath>

#include "base/child_process.h"
#include "base/srgb.h"

namespace ibr::test {

void runEncoder(const std::vector<std::string>& arguments) {
  std::string output;
  const ChildResult result = runChild(
      arguments, {}, [&](std::string_view line) { output += std::string(line) + '\n'; }, [] { return true; });
  INFO(arguments[0] << ": " << output);
  REQUIRE(result.status == 0);
}

Image8 smoothPicture(int width, int height) {
  Image8 picture(width, height, 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double u = double(x) / width, v = double(y) / height;
      const auto wave = [](double t) { return std::uint8_t(std::lround(127.5 + 120 * std::sin(t))); };
      picture.pixel(x, y)[0] = wave(7 * u + 2 * v);
      picture.pixel(x, y)[1] = wave(3 * u * v + 5 * v);
      picture.pixel(x, y)[2] = wave(4 * u - 6 * v);
    }
  return picture;
}

Image8 patches(const std::vector<std::array<int, 3>>& colours) {
  Image8 picture(16 * int(colours.size()), 16, 3);
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      for (std::size_t c = 0; c < 3; ++c) picture.pixel(x, y)[c] = std::uint8_t(colours[std::size_t(x / 16)][c]);
  return picture;
}

std::array<int, 3> patch(const Image8& picture, int number) {
  const auto at = picture.pixel(16 * number + 8, 8);
  return {at[0], at[1], at[2]};
}

double psnr(const Image8& a, const Image8& b) {
  REQUIRE(a.values.size() == b.values.size());
  double sum = 0;
  for (std::size_t i = 0; i < a.values.size(); ++i) sum += std::pow(double(a.values[i]) - double(b.values[i]), 2);
  return 10 * std::log10(255.0 * 255.0 * double(a.values.size()) / std::max(sum, 1e-9));
}

Bytes displayP3() {
  const cmsCIExyY white{0.3127, 0.3290, 1};
  const cmsCIExyYTRIPLE primaries{{0.680, 0.320, 1}, {0.265, 0.690, 1}, {0.150, 0.060, 1}};
  const double sRgb[5] = {2.4, 1 / 1.055, 0.055 / 1.055, 1 / 12.92, 0.04045};
  cmsToneCurve* const curve = cmsBuildParametricToneCurve(nullptr, 4, sRgb);
  cmsToneCurve* const curves[3] = {curve, curve, curve};
  const cmsHPROFILE profile = cmsCreateRGBProfile(&white, &primaries, curves);
  cmsFreeToneCurve(curve);
  cmsUInt32Number size = 0;
  cmsSaveProfileToMem(profile, nullptr, &size);
  Bytes bytes(size);
  cmsSaveProfileToMem(profile, bytes.data(), &size);
  cmsCloseProfile(profile);
  return bytes;
}

Bytes cameraExif(int orientation) {
  return exifBlock(
      {{0x010f, 2, {}, "Maker"}, {0x0110, 2, {}, "M1"}, {0x0112, 3, {std::uint32_t(orientation)}}},
      {{0x829a, 5, {1, 250}}, {0x829d, 5, {28, 10}}, {0x8827, 3, {400}}, {0x920a, 5, {50, 1}}, {0xa405, 3, {75}}},
      false);
}

void encodeAvif(const std::filesystem::path& avif, const std::filesystem::path& png, int primaries, int transfer,
                int bits) {
  runEncoder({"avifenc", "-l", "-d", std::to_string(bits), "--cicp",
              std::to_string(primaries) + "/" + std::to_string(transfer) + "/0", png.string(), avif.string()});
}

Bytes withCodePoints(Bytes heic, int primaries, int transfer) {
  const std::string_view mark = "colrprof";
  const auto box = std::search(heic.begin(), heic.end(), mark.begin(), mark.end());
  REQUIRE(box != heic.end());
  // Matrix of BT.601, full range, as heif-enc encodes.
  const std::uint8_t points[] = {0, std::uint8_t(primaries), 0, std::uint8_t(transfer), 0, 6, 0x80};
  std::ranges::copy(std::string_view("colrnclx"), box);
  std::ranges::copy(points, box + 8);
  return heic;
}

namespace {

// `light(x, y, c)`: linear sRGB.
template <class Light>
void writeDng(const std::filesystem::path& file, int width, int height, const Light& light, const DngOptions& options) {
  constexpr double kBlack = 256, kWhite = 16383;
  TIFF* const tiff = TIFFOpen(file.c_str(), "w");
  REQUIRE(tiff);
  const std::uint8_t version[] = {1, 4, 0, 0}, bayer[] = {0, 1, 1, 2};
  const std::uint16_t pattern[] = {2, 2};
  // From XYZ to the camera: the inverse of sRGB's matrix (IEC 61966-2-1).
  const float matrix[] = {3.2404542f, -1.5371385f, -0.4985314f, -0.9692660f, 1.8760108f,
                          0.0415560f, 0.0556434f,  -0.2040259f, 1.0572252f};
  const float neutral[] = {float(options.neutral[0]), float(options.neutral[1]), float(options.neutral[2])};
  const float black[] = {float(kBlack)};
  const std::uint32_t white[] = {std::uint32_t(kWhite)};
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, width);
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, height);
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 16);
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
  TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_NONE);
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, 32803);  // colour filter array
  TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, height);
  TIFFSetField(tiff, TIFFTAG_ORIENTATION, options.orientation);
  TIFFSetField(tiff, TIFFTAG_MAKE, "Maker");
  TIFFSetField(tiff, TIFFTAG_MODEL, "R1");
  TIFFSetField(tiff, TIFFTAG_UNIQUECAMERAMODEL, "Maker R1");
  TIFFSetField(tiff, TIFFTAG_DNGVERSION, version);
  TIFFSetField(tiff, TIFFTAG_CFAREPEATPATTERNDIM, pattern);
  TIFFSetField(tiff, TIFFTAG_CFAPATTERN, 4, bayer);
  TIFFSetField(tiff, TIFFTAG_COLORMATRIX1, 9, matrix);
  TIFFSetField(tiff, TIFFTAG_CALIBRATIONILLUMINANT1, 21);  // D65
  TIFFSetField(tiff, TIFFTAG_ASSHOTNEUTRAL, 3, neutral);
  TIFFSetField(tiff, TIFFTAG_BLACKLEVEL, 1, black);
  TIFFSetField(tiff, TIFFTAG_WHITELEVEL, 1, white);
  for (int y = 0; y < height; ++y) {
    std::vector<std::uint16_t> row(std::size_t(width), 0);
    for (int x = 0; x < width; ++x) {
      const std::size_t c = std::size_t(y % 2 + x % 2);
      const double value = options.exposure * options.neutral[c] * light(x, y, c);
      row[std::size_t(x)] = std::uint16_t(std::lround(std::min(kWhite, kBlack + (kWhite - kBlack) * value)));
    }
    TIFFWriteScanline(tiff, row.data(), std::uint32_t(y));
  }
  // The Exif IFD is written before the first directory, which refers to it.
  TIFFWriteDirectory(tiff);
  std::uint64_t exif = 0;
  TIFFCreateEXIFDirectory(tiff);
  TIFFSetField(tiff, EXIFTAG_EXPOSURETIME, 0.004 * options.exposure);
  TIFFSetField(tiff, EXIFTAG_FNUMBER, 2.8);
  const std::uint16_t iso[] = {400};
  TIFFSetField(tiff, EXIFTAG_ISOSPEEDRATINGS, 1, iso);
  TIFFSetField(tiff, EXIFTAG_FOCALLENGTH, 50.0);
  TIFFWriteCustomDirectory(tiff, &exif);
  TIFFSetDirectory(tiff, 0);
  TIFFSetField(tiff, TIFFTAG_EXIFIFD, exif);
  TIFFRewriteDirectory(tiff);
  TIFFClose(tiff);
}

}  // namespace

void writeDng(const std::filesystem::path& file, const std::vector<std::array<double, 3>>& light,
              const DngOptions& options) {
  writeDng(
      file, 16 * int(light.size()), 64, [&](int x, int, std::size_t c) { return light[std::size_t(x / 16)][c]; },
      options);
}

void writeDng(const std::filesystem::path& file, const Image8& picture, const DngOptions& options) {
  writeDng(
      file, picture.width, picture.height,
      [&](int x, int y, std::size_t c) { return srgbToLinear(picture.pixel(x, y)[c] / 255.0); }, options);
}

}  // namespace ibr::test
