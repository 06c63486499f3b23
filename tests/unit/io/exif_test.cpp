// SPDX-License-Identifier: Apache-2.0
#include "io/exif.h"

#include <cmath>
#include <span>

#include "io/image_file.h"
#include "support/temporary_folder.h"
#include "unusual_files.h"

using namespace ibr;

namespace {
io::Exif exifOf(const test::Bytes& block) {
  return io::readExif(std::as_bytes(std::span(block)));
}
int orientationOf(const test::Bytes& block) {
  return exifOf(block).orientation;
}

// EXIF block as cameras write it; tag 0x9000 comes first, so the search must skip an entry.
test::Bytes cameraBlock(bool bigEndian) {
  return test::exifBlock({{0x010f, 2, {}, "Maker "}, {0x0110, 2, {}, "M1"}, {0x0112, 3, {6}}},
                         {{0x9000, 4, {1}},
                          {0x829a, 5, {1, 250}},
                          {0x829d, 5, {28, 10}},
                          {0x8827, 3, {400}},
                          {0x920a, 5, {50, 1}},
                          {0xa405, 3, {75}},
                          {0xa434, 2, {}, "50 mm\xe9\n"}},
                         bigEndian);
}
}  // namespace

TEST_CASE("the orientation is found in both byte orders") {
  for (int orientation = 1; orientation <= 8; ++orientation) {
    CHECK(orientationOf(test::exifBlock(orientation, false)) == orientation);
    CHECK(orientationOf(test::exifBlock(orientation, true)) == orientation);
  }
}

TEST_CASE("resetOrientation sets an orientation of any type to 1") {
  for (const bool bigEndian : {false, true})
    for (const int type : {3, 4}) {
      test::Bytes block =
          test::exifBlock({{0x010f, 2, {}, "Maker "}, {0x0112, type, {6}}}, {{0x9000, 4, {1}}}, bigEndian);
      CHECK(orientationOf(block) == 6);
      io::resetOrientation(std::as_writable_bytes(std::span(block)));
      CHECK(orientationOf(block) == 1);
      CHECK(exifOf(block).capture.maker == "Maker");
    }
}

TEST_CASE("an invalid orientation is read as 1") {
  for (const int value : {0, 9, 255}) CHECK(orientationOf(test::exifBlock(value, false)) == 1);
  CHECK(orientationOf({}) == 1);
  CHECK(orientationOf({'I', 'M', 42, 0, 8, 0, 0, 0}) == 1);
  CHECK(orientationOf({'I', 'I', 43, 0, 8, 0, 0, 0}) == 1);
}

TEST_CASE("a damaged EXIF block is never read beyond its end") {
  for (const bool bigEndian : {false, true}) {
    const test::Bytes whole = test::exifBlock(6, bigEndian);
    // A separate heap copy, so that sanitizers detect a read beyond its end.
    for (std::size_t size = 0; size < whole.size() - 6; ++size)
      CHECK(orientationOf(test::Bytes(whole.begin(), whole.begin() + std::ptrdiff_t(size))) == 1);
    for (std::size_t at = 0; at < whole.size(); ++at) {
      test::Bytes damaged = whole;
      damaged[at] = 0xff;
      const int orientation = orientationOf(damaged);
      CHECK((orientation >= 1 && orientation <= 8));
    }
  }
}

TEST_CASE("the exposure is found in both byte orders") {
  for (const bool bigEndian : {false, true}) {
    const io::Exif exif = exifOf(cameraBlock(bigEndian));
    CHECK(exif.orientation == 6);
    const CaptureMetadata wanted{1.0 / 250, 2.8, 400, 50, 75, "Maker", "M1", "50 mm??"};
    CHECK((exif.capture == wanted));
    CHECK(relativeExposure(exif.capture).value() == Approx(400.0 / 250 / (2.8 * 2.8)));
  }
}

TEST_CASE("an ISO value beyond 16 bits is read from the wider tags") {
  const auto isoOf = [](std::vector<test::ExifEntry> entries) {
    return exifOf(test::exifBlock({}, entries, false)).capture.iso;
  };
  CHECK(isoOf({{0x8827, 3, {65535}}, {0x8832, 4, {102400}}}) == 102400);
  CHECK(isoOf({{0x8827, 3, {65535}}, {0x8833, 4, {204800}}}) == 204800);
  CHECK(isoOf({{0x8827, 3, {65535}}, {0x8832, 4, {0}}}) == 0);
  CHECK(isoOf({{0x8827, 3, {65535}}}) == 0);
  CHECK(isoOf({{0x8827, 3, {100}}, {0x8832, 4, {102400}}}) == 100);
}

TEST_CASE("impossible exposure values are ignored") {
  const CaptureMetadata facts =
      exifOf(test::exifBlock({}, {{0x829a, 5, {1, 0}}, {0x829d, 5, {0, 1}}, {0x8827, 5, {100, 1}}, {0x920a, 3, {50}}},
                             false))
          .capture;
  CHECK((facts == CaptureMetadata{}));
  CHECK(!relativeExposure(facts));
  CHECK(!relativeExposure({.exposureTime = 0.01, .fNumber = 2.8}));
  CHECK(!relativeExposure({.exposureTime = 0.01, .iso = 100}));
}

TEST_CASE("a damaged exposure is never read beyond its end, and its values are finite") {
  for (const bool bigEndian : {false, true}) {
    const test::Bytes whole = cameraBlock(bigEndian);
    const auto sound = [](const CaptureMetadata& facts) {
      for (const double v : {facts.exposureTime, facts.fNumber, facts.iso, facts.focalLength, facts.focalLength35})
        if (!(v >= 0) || !std::isfinite(v)) return false;
      return true;
    };
    for (std::size_t size = 0; size < whole.size(); ++size)
      CHECK(sound(exifOf(test::Bytes(whole.begin(), whole.begin() + std::ptrdiff_t(size))).capture));
    for (std::size_t at = 0; at < whole.size(); ++at)
      for (const int value : {0, 255}) {
        test::Bytes damaged = whole;
        damaged[at] = std::uint8_t(value);
        CHECK(sound(exifOf(damaged).capture));
      }
  }
}

TEST_CASE("the exposure is read from JPEG, PNG and TIFF files") {
  const test::TemporaryFolder folder;
  const Image8 picture = test::noisyPicture(16, 8, 3);
  test::writeBytes(folder / "a.jpg",
                   test::withExifBlock(test::makeJpeg(picture, test::JpegKind::baseline), cameraBlock(true)));
  const test::Bytes png = test::makePng(2, 1, 0, 8, {{10, 20}});  // grey
  test::writeBytes(folder / "b.png", test::withPngExif(png, cameraBlock(false)));
  test::writeBytes(folder / "c.tif", test::exifBlock({{0x100, 3, {16}},
                                                      {0x101, 3, {8}},
                                                      {0x102, 3, {8}},
                                                      {0x106, 3, {1}},
                                                      {0x110, 2, {}, "M1"},
                                                      {0x111, 4, {8}},
                                                      {0x115, 3, {1}},
                                                      {0x117, 4, {128}}},
                                                     {{0x8827, 3, {400}}}, false));
  for (const char* name : {"a.jpg", "b.png", "c.tif"}) {
    INFO(name);
    CHECK(probeImage(folder / name).capture.iso == 400);
    CHECK(probeImage(folder / name).capture.model == "M1");
  }
}

TEST_CASE("an EXIF block that is written is read again") {
  const CaptureMetadata whole{1.0 / 250, 2.8, 400, 23.5, 35, "Maker", "M1", "50 mm"};
  for (const CaptureMetadata& capture : {whole, CaptureMetadata{}, CaptureMetadata{.focalLength = 4.2, .model = "A"}}) {
    const std::vector<std::byte> block = io::exifBlock(capture);
    const io::Exif read = io::readExif(block);
    CHECK(read.orientation == 1);
    CHECK(read.capture.exposureTime == Approx(capture.exposureTime));
    CHECK(read.capture.fNumber == Approx(capture.fNumber));
    CHECK(read.capture.focalLength == Approx(capture.focalLength));
    CHECK((read.capture.iso == capture.iso && read.capture.focalLength35 == capture.focalLength35));
    CHECK((read.capture.maker == capture.maker && read.capture.model == capture.model &&
           read.capture.lens == capture.lens));
  }
  for (const GeoLocation& location :
       {GeoLocation{48.858222, -2.2945, 35.5}, {-33.8568, 151.2153, {}}, {0.5, -0.25, -12.0}}) {
    const io::Exif read = io::readExif(io::exifBlock(whole, location));
    REQUIRE(read.location.has_value());
    CHECK(read.location->latitude == Approx(location.latitude).epsilon(1e-8));
    CHECK(read.location->longitude == Approx(location.longitude).epsilon(1e-8));
    CHECK(read.location->altitude.has_value() == location.altitude.has_value());
    if (location.altitude) CHECK(*read.location->altitude == Approx(*location.altitude));
    CHECK(read.capture.iso == 400);
  }
  CHECK_FALSE(io::readExif(io::exifBlock(whole)).location.has_value());
  // Values that EXIF cannot state are left out.
  const io::Exif odd = io::readExif(io::exifBlock({.exposureTime = 1e9, .iso = 1e7, .focalLength = -1}));
  CHECK((odd.capture.exposureTime == 0 && odd.capture.iso == 0 && odd.capture.focalLength == 0));
}
