// SPDX-License-Identifier: Apache-2.0
// Colour spaces of image files, against their definitions.
#include "io/colour.h"

#include <lcms2.h>
#include <png.h>

#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>

#include "io/image_file.h"
#include "support/temporary_folder.h"
#include "unusual_files.h"

using namespace ibr;

namespace {

test::Bytes bytesOf(cmsHPROFILE profile) {
  cmsUInt32Number size = 0;
  REQUIRE(cmsSaveProfileToMem(profile, nullptr, &size));
  test::Bytes bytes(size);
  REQUIRE(cmsSaveProfileToMem(profile, bytes.data(), &size));
  cmsCloseProfile(profile);
  return bytes;
}

// Display P3 as telephones write the profile: primaries of DCI-P3, white point D65, sRGB's curve.
test::Bytes displayP3() {
  const cmsCIExyY white{0.3127, 0.3290, 1};
  const cmsCIExyYTRIPLE primaries{{0.680, 0.320, 1}, {0.265, 0.690, 1}, {0.150, 0.060, 1}};
  const double sRgb[5] = {2.4, 1 / 1.055, 0.055 / 1.055, 1 / 12.92, 0.04045};
  cmsToneCurve* const curve = cmsBuildParametricToneCurve(nullptr, 4, sRgb);
  cmsToneCurve* const curves[3] = {curve, curve, curve};
  cmsHPROFILE profile = cmsCreateRGBProfile(&white, &primaries, curves);
  cmsFreeToneCurve(curve);
  return bytesOf(profile);
}

double linear(double v) {
  return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}
double encoded(double v) {
  v = std::min(std::max(v, 0.0), 1.0);
  return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
}

// Returns the expected sRGB value of a linear colour; `rows`: matrix from the colour's primaries to linear sRGB.
glm::ivec3 expected(glm::dvec3 light, const double (&rows)[3][3]) {
  glm::ivec3 result;
  for (int r = 0; r < 3; ++r)
    result[r] = int(std::lround(255 * encoded(rows[r][0] * light.x + rows[r][1] * light.y + rows[r][2] * light.z)));
  return result;
}

// Computed from the primaries' chromaticities and D65.
constexpr double kP3[3][3] = {
    {1.2249402, -0.2249402, 0}, {-0.0420570, 1.0420570, 0}, {-0.0196376, -0.0786360, 1.0982736}};
constexpr double kAdobe[3][3] = {{1.3983557, -0.3983557, 0}, {0, 1, 0}, {0, -0.0429290, 1.0429290}};

// Colours on a 6 × 6 × 6 grid.
Image8 cube() {
  Image8 picture(36, 6, 3);
  for (int i = 0; i < 216; ++i)
    for (int c = 0; c < 3; ++c)
      picture.values[std::size_t(3 * i + c)] = std::uint8_t(51 * (i / (c == 0 ? 36 : c == 1 ? 6 : 1) % 6));
  return picture;
}

std::vector<test::Bytes> rowsOf(const Image8& picture) {
  std::vector<test::Bytes> rows;
  const std::ptrdiff_t stride = picture.width * 3;
  for (int y = 0; y < picture.height; ++y)
    rows.emplace_back(picture.values.begin() + y * stride, picture.values.begin() + (y + 1) * stride);
  return rows;
}

void checkIsSrgbOf(const Image8& picture, const double (&rows)[3][3], double (*lightOf)(double)) {
  const Image8 before = cube();
  for (int y = 0; y < before.height; ++y)
    for (int x = 0; x < before.width; ++x) {
      const auto from = before.pixel(x, y), to = picture.pixel(x, y);
      const glm::ivec3 right =
          expected({lightOf(from[0] / 255.0), lightOf(from[1] / 255.0), lightOf(from[2] / 255.0)}, rows);
      for (int c = 0; c < 3; ++c) REQUIRE(std::abs(int(to[std::size_t(c)]) - right[c]) <= 2);
    }
}

double adobeLight(double v) {
  return std::pow(v, 563.0 / 256.0);
}

}  // namespace

TEST_CASE("Display P3 in PNG and TIFF is converted to sRGB") {
  test::TemporaryFolder folder;
  const Image8 before = cube();
  const test::Bytes profile = displayP3(), png = test::makePng(36, 6, PNG_COLOR_TYPE_RGB, 8, rowsOf(before));
  test::writeBytes(folder / "a.png", test::withPngProfile(png, profile));
  checkIsSrgbOf(readImage(folder / "a.png"), kP3, linear);
  Image<std::uint16_t> wide(36, 6, 3);
  std::copy(before.values.begin(), before.values.end(), wide.values.begin());
  test::makeTiff(folder / "a.tif", wide, 8, 2, false, 1, {.profile = profile});
  checkIsSrgbOf(readImage(folder / "a.tif"), kP3, linear);
}

TEST_CASE("Display P3 in JPEG is converted after decoding") {
  test::TemporaryFolder folder;
  const test::Bytes jpeg = test::makeJpeg(test::noisyPicture(40, 24, 3), test::JpegKind::baseline);
  test::writeBytes(folder / "plain.jpg", jpeg);
  test::writeBytes(folder / "p3.jpg", test::withJpegProfile(jpeg, displayP3()));
  Image8 right = readImage(folder / "plain.jpg");
  const test::Bytes profile = displayP3();
  io::toSrgb(right, std::as_bytes(std::span(profile)));
  CHECK((readImage(folder / "p3.jpg") == right));
  CHECK((readImage(folder / "plain.jpg") != right));
}

TEST_CASE("Adobe RGB is converted to sRGB, also if only EXIF names the colour space") {
  Image8 picture = cube();
  io::adobeRgbToSrgb(picture);
  checkIsSrgbOf(picture, kAdobe, adobeLight);
  test::TemporaryFolder folder;
  const test::Bytes jpeg = test::makeJpeg(test::noisyPicture(40, 24, 3), test::JpegKind::baseline);
  for (const bool bigEndian : {false, true})
    for (const std::string index : {"R98", "R03"}) {
      test::writeBytes(folder / "a.jpg", test::withExifBlock(jpeg, test::exifBlock({}, {}, bigEndian, index)));
      test::writeBytes(folder / "plain.jpg", jpeg);
      Image8 right = readImage(folder / "plain.jpg");
      if (index == "R03") io::adobeRgbToSrgb(right);
      CHECK((readImage(folder / "a.jpg") == right));
    }
}

TEST_CASE("images in sRGB or with an unusable profile stay unchanged") {
  const Image8 before = cube();
  cmsCIExyY white;
  REQUIRE(cmsWhitePointFromTemp(&white, 5000));
  for (test::Bytes profile :
       {bytesOf(cmsCreate_sRGBProfile()), test::Bytes{}, test::Bytes(200, 7), bytesOf(cmsCreateLab4Profile(&white))}) {
    Image8 picture = before;
    io::toSrgb(picture, std::as_bytes(std::span(profile)));
    CHECK((picture == before));
  }
  test::Bytes cut = displayP3();
  cut.resize(cut.size() / 2);
  Image8 picture = before;
  io::toSrgb(picture, std::as_bytes(std::span(cut)));
  CHECK((picture == before));
}

TEST_CASE("grey images with a profile are converted to the curve of sRGB") {
  cmsToneCurve* const curve = cmsBuildGamma(nullptr, 1.8);
  cmsCIExyY white;
  REQUIRE(cmsWhitePointFromTemp(&white, 5003));
  const test::Bytes profile = bytesOf(cmsCreateGrayProfile(&white, curve));
  cmsFreeToneCurve(curve);
  Image8 picture(256, 1, 3);
  for (int v = 0; v < 256; ++v)
    for (std::size_t c = 0; c < 3; ++c) picture.pixel(v, 0)[c] = std::uint8_t(v);
  io::toSrgb(picture, std::as_bytes(std::span(profile)));
  for (int v = 0; v < 256; ++v) {
    const auto right = int(std::lround(255 * encoded(std::pow(v / 255.0, 1.8))));
    for (std::size_t c = 0; c < 3; ++c) CHECK(std::abs(int(picture.pixel(v, 0)[c]) - right) <= 2);
  }
}
