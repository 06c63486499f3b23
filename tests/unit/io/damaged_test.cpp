// SPDX-License-Identifier: Apache-2.0
// Damaged or truncated files: an Error names the file before memory is allocated; no partial picture is returned.
#include <png.h>
#include <sys/resource.h>
#include <tiffio.h>

#include "io/image_file.h"
#include "support/temporary_folder.h"
#include "unusual_files.h"

using namespace ibr;

namespace {

void cutEverywhere(const test::TemporaryFolder& folder, const std::string& name, const test::Bytes& whole) {
  const auto path = folder / name;
  test::writeBytes(path, whole);
  REQUIRE_NOTHROW(readImage(path));
  std::vector<std::size_t> sizes{0, 1, whole.size() - 2, whole.size() - 1};
  for (std::size_t size = 64; size < whole.size(); size += 64) sizes.push_back(size);
  for (const std::size_t size : sizes) {
    INFO(name << " cut to " << size << " of " << whole.size());
    test::writeBytes(path, test::Bytes(whole.begin(), whole.begin() + std::ptrdiff_t(size)));
    const Error error = test::errorOf([&] { readImage(path); });
    CHECK(error.code() == ErrorCode::invalidInput);
    CHECK_THAT(error.what(), Catch::Contains(path.string()));
  }
}

long peakKilobytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

}  // namespace

TEST_CASE("the error for a truncated image file names the file", "[P1][P2]") {
  test::TemporaryFolder folder;
  const Image8 image = test::noisyPicture(61, 47, 3);
  cutEverywhere(folder, "baseline.jpg", test::makeJpeg(image, test::JpegKind::baseline));
  cutEverywhere(folder, "progressive.jpg", test::makeJpeg(image, test::JpegKind::progressive));
  writeImage(folder / "whole.png", image);
  cutEverywhere(folder, "cut.png", test::readBytes(folder / "whole.png"));
  Image<std::uint16_t> wide(40, 30, 3);
  for (std::size_t i = 0; i < wide.values.size(); ++i) wide.values[i] = std::uint16_t(i * 7 % 251);
  test::makeTiff(folder / "whole.tif", wide, 8, PHOTOMETRIC_RGB, false);
  cutEverywhere(folder, "cut.tif", test::readBytes(folder / "whole.tif"));
}

TEST_CASE("a truncated JPEG with an end marker is refused") {
  test::TemporaryFolder folder;
  test::Bytes bytes = test::makeJpeg(test::noisyPicture(61, 47, 3), test::JpegKind::baseline);
  bytes.resize(bytes.size() / 2);
  bytes.insert(bytes.end(), {0xff, 0xd9});
  test::writeBytes(folder / "a.jpg", bytes);
  CHECK(test::errorOf([&] { readImage(folder / "a.jpg"); }).code() == ErrorCode::invalidInput);
}

TEST_CASE("stray bytes that cameras write are ignored") {
  test::TemporaryFolder folder;
  const Image8 image = test::noisyPicture(32, 32, 3);
  test::Bytes bytes = test::makeJpeg(image, test::JpegKind::baseline);
  test::writeBytes(folder / "clean.jpg", bytes);
  bytes.insert(bytes.end() - 2, {0, 0});                // before the end marker
  bytes.insert(bytes.end(), {1, 2, 3, 4, 5, 6, 7, 8});  // and after the end marker
  test::writeBytes(folder / "stray.jpg", bytes);
  CHECK(readImage(folder / "stray.jpg") == readImage(folder / "clean.jpg"));
}

TEST_CASE("a damaged PNG is refused") {
  test::TemporaryFolder folder;
  writeImage(folder / "a.png", test::noisyPicture(32, 32, 3));
  test::Bytes bytes = test::readBytes(folder / "a.png");
  bytes[bytes.size() / 2] ^= 0x10;
  test::writeBytes(folder / "a.png", bytes);
  CHECK(test::errorOf([&] { readImage(folder / "a.png"); }).code() == ErrorCode::invalidInput);
}

TEST_CASE("sizes over the limits are refused before anything is decoded", "[P1]") {
  test::TemporaryFolder folder;
  const Image8 image = test::noisyPicture(61, 47, 3);
  const test::Bytes baseline = test::makeJpeg(image, test::JpegKind::baseline);
  const test::Bytes progressive = test::makeJpeg(image, test::JpegKind::progressive);
  writeImage(folder / "whole.png", image);
  const test::Bytes png = test::readBytes(folder / "whole.png");
  const long before = peakKilobytes();
  const auto refused = [&](const std::string& name, const test::Bytes& bytes) {
    INFO(name);
    test::writeBytes(folder / name, bytes);
    const Error error = test::errorOf([&] { readImage(folder / name); });
    CHECK(error.code() == ErrorCode::invalidInput);
    CHECK_THAT(error.what(), Catch::Contains(name));
    CHECK_NOTHROW(probeImage(folder / name));
  };
  refused("a.jpg", test::withJpegSize(baseline, 65500, 65500));
  refused("b.jpg", test::withJpegSize(baseline, 16000, 16000));  // a legal size, but too few bytes for the pixels
  refused("c.jpg", test::withJpegSize(progressive, 16000, 16000));
  refused("d.png", test::withPngSize(png, 30000, 30000));
  refused("e.png", test::withPngSize(png, 16000, 16000));
  refused("f.png", test::withPngSize(png, 2000000000, 1));
  CHECK(peakKilobytes() - before < 50 * 1024);
}

TEST_CASE("limits can be lowered and raised") {
  test::TemporaryFolder folder;
  writeImage(folder / "a.png", Image8(20, 10, 3, 1));
  CHECK_NOTHROW(readImage(folder / "a.png", false, {.pixels = 200, .side = 20}));
  CHECK(test::errorOf([&] { readImage(folder / "a.png", false, {.pixels = 199}); }).code() == ErrorCode::invalidInput);
  CHECK(test::errorOf([&] { readImage(folder / "a.png", false, {.side = 19}); }).code() == ErrorCode::invalidInput);
}

TEST_CASE("a progressive JPEG with hundreds of scans is refused", "[P1]") {
  test::TemporaryFolder folder;
  test::writeBytes(folder / "a.jpg", test::makeJpeg(test::noisyPicture(64, 64, 3), test::JpegKind::manyScans));
  const Error error = test::errorOf([&] { readImage(folder / "a.jpg"); });
  CHECK(error.code() == ErrorCode::invalidInput);
  CHECK_THAT(error.what(), Catch::Contains("scans"));
}

TEST_CASE("the error for a file without an image names the file") {
  test::TemporaryFolder folder;
  test::writeBytes(folder / "a.jpg", {'h', 'e', 'l', 'l', 'o'});
  const Error error = test::errorOf([&] { readImage(folder / "a.jpg"); });
  CHECK(error.code() == ErrorCode::invalidInput);
  CHECK_THAT(error.what(), Catch::Contains("a.jpg"));
  CHECK(test::errorOf([&] { readImage(folder / "missing.jpg"); }).code() == ErrorCode::io);
  CHECK(test::errorOf([&] { readImage(folder.path()); }).code() == ErrorCode::io);
  CHECK(test::errorOf([&] { probeImage("/dev/zero"); }).code() == ErrorCode::io);
}
