// SPDX-License-Identifier: Apache-2.0
#include "encoded_files.h"
#include "io/image_file.h"

using namespace ibr;

TEST_CASE("a WebP file comes back as stored, with EXIF and ICC profile applied") {
  const test::TemporaryFolder folder;
  const Image8 picture = test::smoothPicture(90, 61);
  test::Bytes jpeg = test::withJpegProfile(test::makeJpeg(picture, test::JpegKind::baseline), test::displayP3());
  test::writeBytes(folder / "a.jpg", test::withExifBlock(jpeg, test::cameraExif(6)));
  test::runEncoder({"cwebp", "-quiet", "-lossless", "-exact", "-metadata", "all", (folder / "a.jpg").string(), "-o",
                    (folder / "a.webp").string()});
  const ImageFileInfo info = probeImage(folder / "a.webp");
  CHECK(info.format == ImageFormat::webp);
  CHECK((info.width == 90 && info.height == 61 && info.orientation == 6));
  CHECK(info.capture == CaptureMetadata{1.0 / 250, 2.8, 400, 50, 75, "Maker", "M1", ""});
  const Image8 expected = readImage(folder / "a.jpg");
  CHECK(test::psnr(expected, picture) < 35);
  CHECK(test::psnr(readImage(folder / "a.webp"), expected) > 45);
  CHECK(readImage(folder / "a.webp", true).width == 61);
}

TEST_CASE("an animated WebP file is not supported") {
  const test::TemporaryFolder folder;
  writeImage(folder / "a.png", test::smoothPicture(32, 16));
  writeImage(folder / "b.png", test::patches({{200, 100, 50}, {50, 180, 60}}));
  test::runEncoder(
      {"img2webp", "-o", (folder / "a.webp").string(), (folder / "a.png").string(), (folder / "b.png").string()});
  const Error error = test::errorOf([&] { readImage(folder / "a.webp"); });
  CHECK(error.code() == ErrorCode::unsupported);
  CHECK_THAT(error.what(), Catch::Contains("a.webp") && Catch::Contains("animated"));
}
