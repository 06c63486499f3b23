// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <span>

#include "encoded_files.h"
#include "io/image_file.h"

using namespace ibr;

TEST_CASE("HEIC and AVIF files come back as the photograph that was encoded") {
  const test::TemporaryFolder folder;
  const Image8 picture = test::smoothPicture(161, 90);
  writeImage(folder / "a.png", picture);
  for (const auto& [name, format] : {std::pair("a.heic", ImageFormat::heic), {"a.avif", ImageFormat::avif}}) {
    INFO(name);
    test::runEncoder(
        {"heif-enc", "-q", "95", "-p", "chroma=444", "-o", (folder / name).string(), (folder / "a.png").string()});
    const ImageFileInfo info = probeImage(folder / name);
    CHECK(info.format == format);
    CHECK((info.width == 161 && info.height == 90 && info.channels == 3 && info.bitsPerChannel == 8));
    CHECK(info.orientation == 1);
    CHECK(test::psnr(readImage(folder / name), picture) > 40);
    CHECK(isImageFile(folder / name));
    CHECK(unsupportedImageFormat(folder / name).empty());
  }
}

TEST_CASE("a HEIC file's content counts, whatever its name") {
  const test::TemporaryFolder folder;
  writeImage(folder / "a.png", test::smoothPicture(64, 48));
  test::runEncoder({"heif-enc", "-o", (folder / "a.heic").string(), (folder / "a.png").string()});
  std::filesystem::rename(folder / "a.heic", folder / "b.jpg");
  CHECK(probeImage(folder / "b.jpg").format == ImageFormat::heic);
  CHECK(readImage(folder / "b.jpg").width == 64);
}

namespace {

// Changes the EXIF orientation of a file with cameraExif(1) to 6, without a rotation of the file, which newer encoders
// make of it.
void turnExif(const std::filesystem::path& file) {
  const test::Bytes upright = test::cameraExif(1), turned = test::cameraExif(6);
  const auto entry = std::ranges::mismatch(upright, turned).in1 - 9;  // tag, type, count and value are 12 bytes
  test::Bytes bytes = test::readBytes(file);
  const auto found = std::ranges::search(bytes, std::span(entry, 12));
  REQUIRE(found.size() == 12);
  std::ranges::copy(std::span(turned).subspan(std::size_t(entry - upright.begin()), 12), found.begin());
  test::writeBytes(file, bytes);
}

}  // namespace

// The file's own rotation counts, not EXIF's, which tells how the camera was held (ISO/IEC 23008-12 §6.5.10, annex A).
TEST_CASE("a HEIC file keeps the camera's EXIF, whose orientation does not count") {
  const test::TemporaryFolder folder;
  const Image8 picture = test::smoothPicture(120, 80);
  test::writeBytes(folder / "a.jpg",
                   test::withExifBlock(test::makeJpeg(picture, test::JpegKind::baseline), test::cameraExif(1)));
  test::runEncoder({"heif-enc", "-q", "95", "-o", (folder / "a.heic").string(), (folder / "a.jpg").string()});
  turnExif(folder / "a.heic");
  const ImageFileInfo info = probeImage(folder / "a.heic");
  CHECK(info.capture == CaptureMetadata{1.0 / 250, 2.8, 400, 50, 75, "Maker", "M1", ""});
  CHECK((info.orientation == 1 && info.width == 120 && info.height == 80));
  CHECK(test::psnr(readImage(folder / "a.heic", true), picture) > 30);
}

TEST_CASE("rotation and mirroring of AVIF files are applied") {
  const test::TemporaryFolder folder;
  const Image8 picture = test::smoothPicture(120, 80);
  writeImage(folder / "a.png", picture);
  // Quarter turns to the left, and the EXIF orientation of the same turn.
  for (const auto& [turns, orientation] : {std::pair(0, 1), {1, 8}, {2, 3}, {3, 6}}) {
    INFO(turns << " quarter turns");
    test::runEncoder(
        {"avifenc", "-l", "--irot", std::to_string(turns), (folder / "a.png").string(), (folder / "a.avif").string()});
    const Image8 expected = upright(picture, orientation);
    const ImageFileInfo info = probeImage(folder / "a.avif");
    CHECK((info.width == expected.width && info.height == expected.height && info.orientation == 1));
    for (const bool apply : {true, false}) CHECK(test::psnr(readImage(folder / "a.avif", apply), expected) > 45);
  }
  test::runEncoder({"avifenc", "-l", "--imir", "1", (folder / "a.png").string(), (folder / "a.avif").string()});
  CHECK(test::psnr(readImage(folder / "a.avif"), upright(picture, 2)) > 45);
}

TEST_CASE("ICC profiles of HEIC and AVIF files are applied") {
  const test::TemporaryFolder folder;
  const Image8 picture = test::patches({{200, 100, 50}, {50, 180, 60}, {40, 60, 200}, {128, 128, 128}});
  writeImage(folder / "plain.png", picture);
  test::writeBytes(folder / "p3.png", test::withPngProfile(test::readBytes(folder / "plain.png"), test::displayP3()));
  const Image8 expected = readImage(folder / "p3.png");
  REQUIRE(test::psnr(expected, picture) < 35);
  for (const char* name : {"a.heic", "a.avif"}) {
    INFO(name);
    test::runEncoder(
        {"heif-enc", "-q", "99", "-p", "chroma=444", "-o", (folder / name).string(), (folder / "p3.png").string()});
    const Image8 read = readImage(folder / name);
    for (int i = 0; i < 4; ++i)
      for (std::size_t c = 0; c < 3; ++c) CHECK(std::abs(test::patch(read, i)[c] - test::patch(expected, i)[c]) <= 3);
  }
}

TEST_CASE("code points of HEIC and AVIF files are applied: Display P3 equals its ICC profile") {
  const test::TemporaryFolder folder;
  const Image8 picture = test::patches({{200, 100, 50}, {50, 180, 60}, {40, 60, 200}, {128, 128, 128}});
  writeImage(folder / "plain.png", picture);
  test::writeBytes(folder / "p3.png", test::withPngProfile(test::readBytes(folder / "plain.png"), test::displayP3()));
  const Image8 expected = readImage(folder / "p3.png");
  test::encodeAvif(folder / "a.avif", folder / "plain.png", 12, 13);
  test::runEncoder({"heif-enc", "-q", "100", "-p", "chroma=444", "-o", (folder / "icc.heic").string(),
                    (folder / "p3.png").string()});
  test::writeBytes(folder / "a.heic", test::withCodePoints(test::readBytes(folder / "icc.heic"), 12, 13));
  test::writeBytes(folder / "srgb.heic", test::withCodePoints(test::readBytes(folder / "icc.heic"), 1, 13));
  const auto difference = [&](const char* name, const Image8& wanted) {
    const Image8 read = readImage(folder / name);
    int most = 0;
    for (int i = 0; i < 4; ++i)
      for (std::size_t c = 0; c < 3; ++c)
        most = std::max(most, std::abs(test::patch(read, i)[c] - test::patch(wanted, i)[c]));
    return most;
  };
  CHECK(difference("a.avif", expected) <= 1);
  CHECK(difference("a.heic", expected) <= 2);
  CHECK(difference("srgb.heic", picture) <= 2);
}

TEST_CASE("pictures of 10 bits are read, of HDR with diffuse white below full white") {
  const test::TemporaryFolder folder;
  // 16-bit grey steps.
  std::vector<test::Bytes> rows(16);
  for (test::Bytes& row : rows)
    for (int x = 0; x < 64; ++x)
      for (int c = 0; c < 3; ++c) {
        const int value = (x / 16 + 1) * 16383;
        row.push_back(std::uint8_t(value >> 8));
        row.push_back(std::uint8_t(value & 255));
      }
  test::writeBytes(folder / "a.png", test::makePng(64, 16, 2, 16, rows));
  test::encodeAvif(folder / "plain.avif", folder / "a.png", 1, 13, 10);
  CHECK(probeImage(folder / "plain.avif").bitsPerChannel == 10);
  const Image8 plain = readImage(folder / "plain.avif");
  for (int i = 0; i < 4; ++i) CHECK(std::abs(test::patch(plain, i)[1] - (i + 1) * 255 / 4) <= 1);
  // PQ: the values are 5, 92, 983 and 10000 cd/m²; diffuse white is 203.
  test::encodeAvif(folder / "pq.avif", folder / "a.png", 9, 16, 10);
  const Image8 pq = readImage(folder / "pq.avif");
  CHECK(std::abs(test::patch(pq, 0)[1] - 43) <= 2);
  CHECK(std::abs(test::patch(pq, 1)[1] - 179) <= 2);
  CHECK(test::patch(pq, 2)[1] >= 253);
  CHECK(test::patch(pq, 3)[1] == 255);
}
