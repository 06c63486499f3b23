// SPDX-License-Identifier: Apache-2.0
// Metadata of photographs: found by kind, and removed without touching a pixel.
#include "io/metadata.h"

#include <algorithm>

#include "base/file.h"
#include "io/exif.h"
#include "io/image_file.h"
#include "support/temporary_folder.h"
#include "unusual_files.h"

using namespace ibr;

namespace {

bool has(const std::vector<std::string>& kinds, const std::string& kind) {
  return std::ranges::find(kinds, kind) != kinds.end();
}

test::Bytes fullExif(int orientation) {
  return test::exifBlock({{0x010e, 2, {}, "comment of the picture"},
                          {0x010f, 2, {}, "Maker"},
                          {0x0112, 3, {std::uint32_t(orientation)}},
                          {0x0132, 2, {}, "2024:05:01 12:00:00"},
                          {0x013b, 2, {}, "A. Photographer"},
                          {0x8825, 4, {8}}},
                         {{0x829a, 5, {1, 250}}, {0x9003, 2, {}, "2024:05:01 12:00:00"}, {0xa431, 2, {}, "SN 12345"}},
                         true);
}

// Inserts a segment after the JPEG's first two bytes.
test::Bytes withSegment(test::Bytes jpeg, std::uint8_t marker, const std::string& text) {
  test::Bytes segment{0xff, marker, std::uint8_t((text.size() + 2) >> 8), std::uint8_t((text.size() + 2) & 255)};
  segment.insert(segment.end(), text.begin(), text.end());
  jpeg.insert(jpeg.begin() + 2, segment.begin(), segment.end());
  return jpeg;
}

test::Bytes strippedBytes(const test::Bytes& bytes) {
  const std::vector<std::byte> stripped = withoutMetadata(std::as_bytes(std::span(bytes)), "a");
  test::Bytes result(stripped.size());
  std::ranges::transform(stripped, result.begin(), [](std::byte b) { return std::to_integer<std::uint8_t>(b); });
  return result;
}

bool contains(const test::Bytes& bytes, const std::string& text) {
  return std::search(bytes.begin(), bytes.end(), text.begin(), text.end()) != bytes.end();
}

}  // namespace

TEST_CASE("a JPEG without metadata has the same pixels, profile and orientation") {
  const test::TemporaryFolder folder;
  const Image8 picture = test::noisyPicture(61, 47, 3);
  // Any profile: the name of a colour space is enough for the reader to try it.
  const test::Bytes profile(300, 7);
  for (const test::JpegKind kind : {test::JpegKind::baseline, test::JpegKind::progressive, test::JpegKind::rgb})
    for (const int orientation : {1, 6}) {
      test::Bytes jpeg = test::withJpegProfile(test::makeJpeg(picture, kind), profile);
      jpeg = withSegment(jpeg, 0xe1, "http://ns.adobe.com/xap/1.0/ edited by someone");
      jpeg = withSegment(jpeg, 0xed, "Photoshop 3.0 press");
      jpeg = withSegment(jpeg, 0xfe, "a private remark");
      jpeg = test::withExifBlock(jpeg, fullExif(orientation));
      for (const char c : std::string("a video after the picture")) jpeg.push_back(std::uint8_t(c));
      test::writeBytes(folder / "a.jpg", jpeg);
      const std::vector<std::string> kinds = metadataKinds(folder / "a.jpg");
      for (const char* wanted : {"camera", "comment", "editing history (XMP)", "exposure", "location", "names",
                                 "serial number", "time", "other data"}) {
        INFO(wanted);
        CHECK(has(kinds, wanted));
      }
      CHECK_FALSE(has(kinds, "maker note"));
      const test::Bytes stripped = strippedBytes(jpeg);
      test::writeBytes(folder / "b.jpg", stripped);
      CHECK(metadataKinds(folder / "b.jpg").empty());
      CHECK(readImage(folder / "b.jpg") == readImage(folder / "a.jpg"));
      CHECK(probeImage(folder / "b.jpg").orientation == orientation);
      CHECK(probeImage(folder / "b.jpg").capture == CaptureMetadata{});
      CHECK(contains(stripped, "ICC_PROFILE"));
      for (const char* gone : {"Maker", "2024:", "A. Photographer", "SN 12345", "xap", "press", "private", "video"}) {
        INFO(gone);
        CHECK(contains(jpeg, gone));
        CHECK_FALSE(contains(stripped, gone));
      }
      CHECK(strippedBytes(stripped) == stripped);
    }
}

TEST_CASE("a PNG without metadata has the same pixels, profile and orientation") {
  const test::TemporaryFolder folder;
  const Image8 picture = test::noisyPicture(40, 30, 3);
  for (const int orientation : {1, 8}) {
    writeImage(folder / "plain.png", picture, {{"Author", "someone"}});
    const test::Bytes png = test::withPngExif(test::readBytes(folder / "plain.png"), fullExif(orientation));
    test::writeBytes(folder / "a.png", png);
    const std::vector<std::string> kinds = metadataKinds(folder / "a.png");
    for (const char* wanted : {"camera", "comment", "location", "time", "names"}) CHECK(has(kinds, wanted));
    const test::Bytes stripped = strippedBytes(png);
    test::writeBytes(folder / "b.png", stripped);
    CHECK(metadataKinds(folder / "b.png").empty());
    CHECK(readImage(folder / "b.png") == picture);
    CHECK(probeImage(folder / "b.png").orientation == orientation);
    CHECK_FALSE(contains(stripped, "someone"));
    CHECK_FALSE(contains(stripped, "Maker"));
  }
}

TEST_CASE("files without metadata stay as they are, and damaged ones are errors") {
  const test::TemporaryFolder folder;
  const Image8 picture = test::noisyPicture(40, 30, 3);
  writeImage(folder / "a.png", picture);
  writeImage(folder / "a.jpg", picture);
  for (const char* name : {"a.png", "a.jpg"}) {
    const test::Bytes whole = test::readBytes(folder / name);
    CHECK(strippedBytes(whole) == whole);
    CHECK(metadataKinds(folder / name).empty());
    for (std::size_t size = 3; size < whole.size(); size += 1 + whole.size() / 50) {
      const test::Bytes cut(whole.begin(), whole.begin() + long(size));
      INFO(name << " cut to " << size);
      const Error error = test::errorOf([&] { strippedBytes(cut); });
      CHECK((error.code() == ErrorCode::invalidInput || error.code() == ErrorCode::unsupported));
      test::writeBytes(folder / "cut", cut);
      CHECK_NOTHROW(metadataKinds(folder / "cut"));
    }
  }
  CHECK(test::errorOf([&] { strippedBytes({'G', 'I', 'F'}); }).code() == ErrorCode::unsupported);
}
