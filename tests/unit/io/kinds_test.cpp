// SPDX-License-Identifier: Apache-2.0
// Image files of every kind are read as the RGB that they show.
#include <png.h>
#include <tiffio.h>

#include <algorithm>
#include <functional>

#include "base/file.h"
#include "io/decoded.h"
#include "io/image_file.h"
#include "support/temporary_folder.h"
#include "unusual_files.h"

using namespace ibr;

TEST_CASE("16-bit PNG is rounded to 8 bits, in RGB order") {
  test::TemporaryFolder folder;
  // 257 · n is exactly n in 8 bits; 128 more or less is the rounding limit.
  const test::Bytes row{0x12, 0x12, 0x80, 0x00, 0xff, 0xff, 0x00, 0x7f, 0x00, 0x81, 0xff, 0x7e};
  test::writeBytes(folder / "a.png", test::makePng(2, 1, PNG_COLOR_TYPE_RGB, 16, {row}));
  CHECK(probeImage(folder / "a.png").bitsPerChannel == 16);
  const Image8 image = readImage(folder / "a.png");
  REQUIRE(image.channels == 3);
  CHECK(image.values == std::vector<std::uint8_t>{0x12, 0x80, 0xff, 0, 1, 0xfe});
}

TEST_CASE("grey PNG of 1, 2, 4, 8 and 16 bits becomes grey RGB") {
  test::TemporaryFolder folder;
  const std::pair<int, test::Bytes> rows[] = {
      {1, {0x40}}, {2, {0x30}}, {4, {0x0f}}, {8, {0, 255}}, {16, {0, 0, 255, 255}}};
  for (const auto& [bits, row] : rows) {
    test::writeBytes(folder / "a.png", test::makePng(2, 1, PNG_COLOR_TYPE_GRAY, bits, {row}));
    CHECK(readImage(folder / "a.png").values == std::vector<std::uint8_t>{0, 0, 0, 255, 255, 255});
  }
}

TEST_CASE("palette and alpha PNG become RGB") {
  test::TemporaryFolder folder;
  test::writeBytes(folder / "palette.png", test::makePng(3, 1, PNG_COLOR_TYPE_PALETTE, 2, {{0x18}}, false,
                                                         {9, 8, 7, 10, 20, 30, 200, 100, 50}));
  CHECK(readImage(folder / "palette.png").values == std::vector<std::uint8_t>{9, 8, 7, 10, 20, 30, 200, 100, 50});
  CHECK(probeImage(folder / "palette.png").channels == 3);
  const Image8 withAlpha = test::noisyPicture(5, 4, 4);
  writeImage(folder / "alpha.png", withAlpha);
  CHECK(probeImage(folder / "alpha.png").channels == 4);
  const Image8 image = readImage(folder / "alpha.png");
  REQUIRE(image.channels == 3);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 5; ++x)
      for (std::size_t c = 0; c < 3; ++c) CHECK(image.pixel(x, y)[c] == withAlpha.pixel(x, y)[c]);
}

TEST_CASE("an interlaced PNG gives the same image") {
  test::TemporaryFolder folder;
  const Image8 image = test::noisyPicture(13, 11, 3);
  std::vector<test::Bytes> rows;
  for (int y = 0; y < image.height; ++y)
    rows.emplace_back(image.values.begin() + y * 39, image.values.begin() + (y + 1) * 39);
  test::writeBytes(folder / "a.png", test::makePng(13, 11, PNG_COLOR_TYPE_RGB, 8, rows, true));
  CHECK(readImage(folder / "a.png") == image);
}

TEST_CASE("baseline, progressive, arithmetic, RGB and grey JPEG are close to the written image") {
  test::TemporaryFolder folder;
  Image8 smooth(40, 24, 3);
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 40; ++x) {
      smooth.pixel(x, y)[0] = std::uint8_t(6 * x);
      smooth.pixel(x, y)[1] = std::uint8_t(10 * y);
      smooth.pixel(x, y)[2] = 40;
    }
  for (const auto kind :
       {test::JpegKind::baseline, test::JpegKind::progressive, test::JpegKind::arithmetic, test::JpegKind::rgb}) {
    test::writeBytes(folder / "a.jpg", test::makeJpeg(smooth, kind));
    const Image8 image = readImage(folder / "a.jpg");
    REQUIRE((image.width == 40 && image.height == 24 && image.channels == 3));
    for (std::size_t i = 0; i < image.values.size(); ++i)
      REQUIRE(std::abs(int(image.values[i]) - int(smooth.values[i])) <= 8);
  }
  Image8 grey(16, 8, 1, 77);
  test::writeBytes(folder / "grey.jpg", test::makeJpeg(grey, test::JpegKind::baseline));
  CHECK(probeImage(folder / "grey.jpg").channels == 1);
  CHECK(readImage(folder / "grey.jpg") == Image8(16, 8, 3, 77));
}

TEST_CASE("CMYK is refused, and the error names the remedy") {
  test::TemporaryFolder folder;
  for (const auto kind : {test::JpegKind::cmyk, test::JpegKind::ycck}) {
    test::writeBytes(folder / "a.jpg", test::makeJpeg(test::noisyPicture(16, 16, 4), kind));
    CHECK(test::errorOf([&] { probeImage(folder / "a.jpg"); }).code() == ErrorCode::unsupported);
    const Error error = test::errorOf([&] { readImage(folder / "a.jpg"); });
    CHECK(error.code() == ErrorCode::unsupported);
    CHECK_THAT(error.what(), Catch::Contains("a.jpg") && Catch::Contains("CMYK") && Catch::Contains("RGB"));
  }
  test::makeTiff(folder / "a.tif", Image<std::uint16_t>(4, 4, 4, 9), 8, PHOTOMETRIC_SEPARATED, false);
  CHECK(test::errorOf([&] { probeImage(folder / "a.tif"); }).code() == ErrorCode::unsupported);
  const Error error = test::errorOf([&] { readImage(folder / "a.tif"); });
  CHECK(error.code() == ErrorCode::unsupported);
  CHECK_THAT(error.what(), Catch::Contains("a.tif") && Catch::Contains("CMYK") && Catch::Contains("RGB"));
}

TEST_CASE("16-bit grey PNG with alpha is rounded to 8-bit grey") {
  test::TemporaryFolder folder;
  const test::Bytes row{0x00, 0x81, 0x12, 0x34, 0xff, 0x7e, 0, 0};
  test::writeBytes(folder / "a.png", test::makePng(2, 1, PNG_COLOR_TYPE_GRAY_ALPHA, 16, {row}));
  CHECK(readImage(folder / "a.png").values == std::vector<std::uint8_t>{1, 1, 1, 0xfe, 0xfe, 0xfe});
}

TEST_CASE("TIFF in strips, tiles, planes, both byte orders and with wide offsets gives the same image") {
  test::TemporaryFolder folder;
  const Image8 small = test::noisyPicture(21, 18, 3);
  for (const int bits : {8, 16}) {
    Image<std::uint16_t> picture(small.width, small.height, 3);
    for (std::size_t i = 0; i < small.values.size(); ++i)
      picture.values[i] = std::uint16_t(bits == 8 ? small.values[i] : 257 * small.values[i] + int(i % 256) - 128);
    for (const char* mode : {"w", "wb", "w8", "wb8"})
      for (const bool planar : {false, true})
        for (const int tile : {0, 16}) {
          INFO(bits << " bits, " << mode << ", planar " << planar << ", tiles of " << tile);
          test::makeTiff(folder / "a.tif", picture, bits, PHOTOMETRIC_RGB, false, 1, {mode, planar, tile});
          CHECK(probeImage(folder / "a.tif").bitsPerChannel == bits);
          CHECK((readImage(folder / "a.tif") == small));
        }
  }
}

TEST_CASE("16-bit grey TIFF is rounded, also if white is 0") {
  test::TemporaryFolder folder;
  Image<std::uint16_t> grey(3, 2, 1);
  grey.values = {0, 0x007f, 0x0081, 0x1280, 0xff7e, 0xffff};
  const std::vector<int> right{0, 0, 1, 0x12, 0xfe, 0xff};
  for (const char* mode : {"w", "wb"})
    for (const bool inverted : {false, true}) {
      test::makeTiff(folder / "a.tif", grey, 16, inverted ? PHOTOMETRIC_MINISWHITE : PHOTOMETRIC_MINISBLACK, false, 1,
                     {mode});
      const Image8 image = readImage(folder / "a.tif");
      for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t c = 0; c < 3; ++c)
          CHECK(int(image.values[3 * i + c]) == (inverted ? 255 - right[i] : right[i]));
    }
}

TEST_CASE("two-channel TIFF files are refused, and the error names the remedy") {
  test::TemporaryFolder folder;
  test::makeTiff(folder / "b.tif", Image<std::uint16_t>(4, 4, 2, 9), 16, PHOTOMETRIC_RGB, false);
  const Error error = test::errorOf([&] { readImage(folder / "b.tif"); });
  CHECK(error.code() == ErrorCode::unsupported);
  CHECK_THAT(error.what(), Catch::Contains("b.tif") && Catch::Contains("RGB") && Catch::Contains("16"));
}

TEST_CASE("the error for other formats names the format by content, not by extension") {
  test::TemporaryFolder folder;
  using namespace std::string_literals;
  const std::pair<const char*, std::string> kinds[] = {{"GIF", "GIF89a"s},
                                                       {"JPEG XL", "\xff\x0a\0"s},
                                                       {"video",
                                                        "\0\0\0\x18"
                                                        "ftypqt  \0\0\0\0"s}};
  for (const auto& [kind, begin] : kinds) {
    test::writeBytes(folder / "a.jpg", test::Bytes(begin.begin(), begin.end()));
    CHECK(unsupportedImageFormat(folder / "a.jpg") == kind);
    CHECK(!isImageFile(folder / "a.jpg"));
    for (const auto& read :
         {std::function([&] { readImage(folder / "a.jpg"); }), std::function([&] { probeImage(folder / "a.jpg"); })}) {
      const Error error = test::errorOf(read);
      CHECK(error.code() == ErrorCode::unsupported);
      CHECK_THAT(error.what(), Catch::Contains("a.jpg") && Catch::Contains(kind) && Catch::Contains("JPEG"));
    }
  }
  writeImage(folder / "b.png", Image8(2, 2, 3, 9));
  CHECK(unsupportedImageFormat(folder / "b.png").empty());
  test::writeBytes(folder / "empty.jpg", {});
  CHECK_THAT(test::errorOf([&] { readImage(folder / "empty.jpg"); }).what(),
             Catch::Contains("empty.jpg") && Catch::EndsWith("empty"));
}

TEST_CASE("TIFF of 8 and 16 bits in grey, RGB and opaque RGBA is read as RGB") {
  test::TemporaryFolder folder;
  Image<std::uint16_t> rgb(2, 1, 3);
  rgb.values = {1, 2, 3, 250, 251, 252};
  test::makeTiff(folder / "a.tif", rgb, 8, PHOTOMETRIC_RGB, false);
  CHECK(readImage(folder / "a.tif").values == std::vector<std::uint8_t>{1, 2, 3, 250, 251, 252});
  CHECK(probeImage(folder / "a.tif").width == 2);
  rgb.values = {0x1212, 0x8000, 0xffff, 0x007f, 0x0081, 0xff7e};
  test::makeTiff(folder / "b.tif", rgb, 16, PHOTOMETRIC_RGB, false);
  CHECK(readImage(folder / "b.tif").values == std::vector<std::uint8_t>{0x12, 0x80, 0xff, 0, 1, 0xfe});
  test::makeTiff(folder / "c.tif", Image<std::uint16_t>(3, 2, 1, 88), 8, PHOTOMETRIC_MINISBLACK, false);
  CHECK(readImage(folder / "c.tif") == Image8(3, 2, 3, 88));
  Image<std::uint16_t> rgba(1, 1, 4);
  rgba.values = {10, 20, 30, 255};
  test::makeTiff(folder / "d.tif", rgba, 8, PHOTOMETRIC_RGB, true);
  CHECK(readImage(folder / "d.tif").values == std::vector<std::uint8_t>{10, 20, 30});
  rgba.values[3] = 128;
  test::makeTiff(folder / "e.tif", rgba, 8, PHOTOMETRIC_RGB, true);
  CHECK(test::errorOf([&] { readImage(folder / "e.tif"); }).code() == ErrorCode::unsupported);
}

TEST_CASE("the eight EXIF orientations turn the stored image upright, but only on request") {
  test::TemporaryFolder folder;
  // Upright picture of 16 × 8 px: four flat blocks, which JPEG preserves. Each orientation is stored as cameras do.
  const std::uint8_t tl = 10, tr = 80, bl = 160, br = 240;
  const std::uint8_t stored[9][4] = {{},
                                     {tl, tr, bl, br},
                                     {tr, tl, br, bl},
                                     {br, bl, tr, tl},
                                     {bl, br, tl, tr},
                                     {tl, bl, tr, br},
                                     {tr, br, tl, bl},
                                     {br, tr, bl, tl},
                                     {bl, tl, br, tr}};
  for (int orientation = 1; orientation <= 8; ++orientation) {
    const int width = orientation < 5 ? 32 : 16, height = 48 - width;
    Image8 image(width, height, 1);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        image.pixel(x, y)[0] = stored[orientation][(y >= height / 2 ? 2 : 0) + (x >= width / 2 ? 1 : 0)];
    test::writeBytes(folder / "a.jpg", test::withExif(test::makeJpeg(image, test::JpegKind::baseline), orientation));
    INFO("orientation " << orientation);
    CHECK(probeImage(folder / "a.jpg").orientation == orientation);
    const Image8 asStored = readImage(folder / "a.jpg");
    CHECK((asStored.width == width && asStored.height == height));
    const Image8 upright = readImage(folder / "a.jpg", true);
    REQUIRE((upright.width == 32 && upright.height == 16));
    CHECK(std::abs(upright.pixel(4, 4)[0] - tl) <= 2);
    CHECK(std::abs(upright.pixel(28, 4)[0] - tr) <= 2);
    CHECK(std::abs(upright.pixel(4, 12)[0] - bl) <= 2);
    CHECK(std::abs(upright.pixel(28, 12)[0] - br) <= 2);
  }
}

TEST_CASE("PNG and TIFF have the orientations of JPEG") {
  test::TemporaryFolder folder;
  const Image8 stored = test::noisyPicture(8, 16, 3);
  std::vector<test::Bytes> rows;
  Image<std::uint16_t> wide(8, 16, 3);
  std::ranges::copy(stored.values, wide.values.begin());
  for (int y = 0; y < 16; ++y) rows.emplace_back(stored.values.begin() + y * 24, stored.values.begin() + (y + 1) * 24);
  const test::Bytes png = test::makePng(8, 16, PNG_COLOR_TYPE_RGB, 8, rows);
  // Positions in the stored picture of the upright picture's first pixel and of its right neighbour.
  const int first[9][4] = {{},           {0, 0, 1, 0},   {7, 0, 6, 0},   {7, 15, 6, 15}, {0, 15, 1, 15},
                           {0, 0, 0, 1}, {0, 15, 0, 14}, {7, 15, 7, 14}, {7, 0, 7, 1}};
  for (int orientation = 1; orientation <= 8; ++orientation) {
    INFO("orientation " << orientation);
    test::writeBytes(folder / "a.png", test::withPngExif(png, test::exifBlock(orientation, orientation % 2 == 0)));
    test::makeTiff(folder / "a.tif", wide, 8, PHOTOMETRIC_RGB, false, orientation);
    for (const char* name : {"a.png", "a.tif"}) {
      INFO(name);
      CHECK(probeImage(folder / name).orientation == orientation);
      CHECK((readImage(folder / name) == stored));
      const Image8 upright = readImage(folder / name, true);
      REQUIRE(upright.width == (orientation < 5 ? 8 : 16));
      const auto& [x0, y0, x1, y1] = first[orientation];
      for (std::size_t c = 0; c < 3; ++c) {
        CHECK(upright.pixel(0, 0)[c] == stored.pixel(x0, y0)[c]);
        CHECK(upright.pixel(1, 0)[c] == stored.pixel(x1, y1)[c]);
      }
    }
  }
}

TEST_CASE("formats that the program ibr-decode reads are known by content") {
  test::TemporaryFolder folder;
  using namespace std::string_literals;
  const std::pair<ImageFormat, std::string> kinds[] = {{ImageFormat::heic,
                                                        "\0\0\0\x18"
                                                        "ftypheic\0\0\0\0"s},
                                                       {ImageFormat::heic,
                                                        "\0\0\0\x18"
                                                        "ftypmif1\0\0\0\0"s},
                                                       {ImageFormat::avif,
                                                        "\0\0\0\x18"
                                                        "ftypavif\0\0\0\0"s},
                                                       {ImageFormat::webp, "RIFF\x10\0\0\0WEBPVP8 "s},
                                                       {ImageFormat::raw,
                                                        "\0\0\0\x18"
                                                        "ftypcrx \0\0\0\0"s},
                                                       {ImageFormat::raw, "FUJIFILMCCD-RAW "s},
                                                       {ImageFormat::raw, "II*\0\x10\0\0\0CR\2\0"s}};
  for (const auto& [format, begin] : kinds) {
    test::writeBytes(folder / "a.jpg", test::Bytes(begin.begin(), begin.end()));
    CHECK(io::programFormat(readFile(folder / "a.jpg")) == format);
    CHECK(isImageFile(folder / "a.jpg"));
    CHECK(unsupportedImageFormat(folder / "a.jpg").empty());
  }
  for (const bool preview : {false, true}) {
    test::makeTiff(folder / "a.tif", Image<std::uint16_t>(4, 4, 3, 9), 8, PHOTOMETRIC_RGB, false, 1,
                   {.preview = preview});
    CHECK(io::programFormat(readFile(folder / "a.tif")).has_value() == preview);
  }
}
