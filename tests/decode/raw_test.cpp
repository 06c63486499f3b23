// SPDX-License-Identifier: Apache-2.0
// Raw files: linear light with the camera's white balance. DNG only; CR2, CR3, NEF and ARW need a real camera's file.
#include <algorithm>
#include <cmath>

#include "base/srgb.h"
#include "encoded_files.h"
#include "io/exif.h"
#include "io/image_file.h"

using namespace ibr;

namespace {

const std::vector<std::array<double, 3>> kLight{{0.5, 0.5, 0.5},  {0.4, 0.1, 0.05},   {0.03, 0.3, 0.02},
                                                {0.05, 0.1, 0.6}, {0.01, 0.01, 0.01}, {0.9, 0.9, 0.9}};

std::array<int, 3> expected(std::array<double, 3> light, double exposure) {
  std::array<int, 3> colour{};
  for (std::size_t c = 0; c < 3; ++c)
    colour[c] = int(std::lround(255 * linearToSrgb(std::min(1.0, exposure * light[c]))));
  return colour;
}

}  // namespace

TEST_CASE("a DNG file is linear light, with the camera's white balance") {
  const test::TemporaryFolder folder;
  for (const double exposure : {1.0, 0.25})
    for (const std::array<double, 3> neutral : {std::array{0.5, 1.0, 0.6}, {1.0, 1.0, 1.0}, {0.7, 1.0, 0.4}}) {
      test::writeDng(folder / "a.dng", kLight, {neutral, exposure});
      const ImageFileInfo info = probeImage(folder / "a.dng");
      CHECK(info.format == ImageFormat::raw);
      CHECK(info.orientation == 1);
      const Image8 picture = readImage(folder / "a.dng");
      REQUIRE((picture.width == info.width && picture.height == info.height));
      for (std::size_t i = 0; i < kLight.size(); ++i) {
        INFO("patch " << i << ", exposure " << exposure << ", neutral " << neutral[0]);
        const auto at = picture.pixel(16 * int(i) + 8, 32);
        for (std::size_t c = 0; c < 3; ++c) CHECK(std::abs(int(at[c]) - expected(kLight[i], exposure)[c]) <= 1);
      }
    }
}

TEST_CASE("a DNG file's orientation and capture metadata are read") {
  const test::TemporaryFolder folder;
  for (const int orientation : {1, 3, 6, 8}) {
    test::writeDng(folder / "a.dng", kLight, {.exposure = 0.5, .orientation = orientation});
    const ImageFileInfo info = probeImage(folder / "a.dng");
    CHECK(info.orientation == orientation);
    CHECK((info.width == 96 && info.height == 64));
    CHECK(info.capture.exposureTime == Approx(0.002));
    CHECK(info.capture.fNumber == Approx(2.8));
    CHECK(info.capture.iso == Approx(400));
    CHECK(info.capture.focalLength == Approx(50));
    CHECK(info.capture.maker == "Maker");
    CHECK(info.capture.model == "R1");
    const Image8 turned = readImage(folder / "a.dng", true);
    CHECK(turned.width == (orientation >= 5 ? 64 : 96));
  }
}

TEST_CASE("raw files that start as TIFF are told from pictures by their first directory") {
  const test::TemporaryFolder folder;
  test::writeDng(folder / "a.tif", kLight);
  CHECK(probeImage(folder / "a.tif").format == ImageFormat::raw);
  Image<std::uint16_t> wide(40, 30, 3);
  test::makeTiff(folder / "b.dng", wide, 8, 2, false);
  CHECK(probeImage(folder / "b.dng").format == ImageFormat::tiff);
  const auto isRaw = [](const test::Bytes& block) { return io::isRawTiff(std::as_bytes(std::span(block))); };
  CHECK(isRaw(test::exifBlock({{0x00fe, 4, {1}}}, {}, true)));       // a reduced image first: NEF, ARW
  CHECK(isRaw(test::exifBlock({{0x0103, 3, {34713}}}, {}, false)));  // Nikon's compression
  CHECK_FALSE(isRaw(test::exifBlock({{0x0103, 3, {5}}}, {}, false)));
  CHECK_FALSE(isRaw({'I', 'I', 42, 0}));
}

TEST_CASE("a raw file without its sensor data is refused") {
  const test::TemporaryFolder folder;
  test::writeDng(folder / "a.dng", std::vector<std::array<double, 3>>(40, {0.2, 0.3, 0.4}));
  test::Bytes bytes = test::readBytes(folder / "a.dng");
  // Position of a value in the last directory: a tag of one SHORT (3) or LONG (4).
  const auto value = [&](std::uint8_t tag, std::uint8_t type) {
    const std::uint8_t entry[] = {tag, 1, type, 0, 1, 0, 0, 0};
    const auto found = std::find_end(bytes.begin(), bytes.end(), std::begin(entry), std::end(entry));
    REQUIRE(found != bytes.end());
    return found + 8;
  };
  // The data starts behind the end of the file, as in a copy of a file's first part.
  for (int i = 0; i < 4; ++i) value(0x11, 4)[i] = std::uint8_t((bytes.size() + 100'000) >> 8 * i);  // StripOffsets
  for (const int compression : {1, 7}) {  // none; lossless JPEG, whose absence LibRaw does not report
    INFO(compression);
    value(0x03, 3)[0] = std::uint8_t(compression);
    test::writeBytes(folder / "cut.dng", bytes);
    const Error error = test::errorOf([&] { readImage(folder / "cut.dng"); });
    CHECK(error.code() == ErrorCode::invalidInput);
    CHECK_THAT(error.what(), Catch::Contains("cut.dng"));
  }
}
