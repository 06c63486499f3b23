// SPDX-License-Identifier: Apache-2.0
#include "io/image_file.h"

#include "support/temporary_folder.h"
#include "unusual_files.h"

using namespace ibr;

TEST_CASE("PNG gives back every value, at every narrow size") {
  test::TemporaryFolder folder;
  const std::pair<int, int> sizes[] = {{1, 1}, {1, 40}, {40, 1}, {2, 3}, {257, 3}};
  for (const auto& [width, height] : sizes) {
    const Image8 image = test::noisyPicture(width, height, 3);
    writeImage(folder / "a.png", image);
    CHECK(readImage(folder / "a.png") == image);
    const ImageFileInfo info = probeImage(folder / "a.png");
    CHECK((info.width == width && info.height == height && info.channels == 3 && info.bitsPerChannel == 8));
  }
}

TEST_CASE("JPEG of narrow sizes keeps its size") {
  test::TemporaryFolder folder;
  const std::pair<int, int> sizes[] = {{1, 1}, {1, 40}, {40, 1}, {17, 9}};
  for (const auto& [width, height] : sizes) {
    writeImage(folder / "a.jpg", Image8(width, height, 3, 90));
    CHECK(readImage(folder / "a.jpg") == Image8(width, height, 3, 90));
  }
}

TEST_CASE("JPEG quality is obeyed") {
  test::TemporaryFolder folder;
  const Image8 image = test::noisyPicture(64, 64, 3);
  writeImage(folder / "low.jpg", image, 40);
  writeImage(folder / "high.JPEG", image, 98);
  CHECK(std::filesystem::file_size(folder / "low.jpg") < std::filesystem::file_size(folder / "high.JPEG"));
  const Image8 high = readImage(folder / "high.JPEG");
  int largest = 0;
  for (std::size_t i = 0; i < image.values.size(); ++i)
    largest = std::max(largest, std::abs(int(image.values[i]) - int(high.values[i])));
  CHECK(largest <= 16);
}

TEST_CASE("the same picture gives the same bytes") {
  test::TemporaryFolder folder;
  const Image8 image = test::noisyPicture(50, 30, 3);
  for (const char* extension : {".png", ".jpg"}) {
    writeImage(folder / ("a" + std::string(extension)), image);
    writeImage(folder / ("b" + std::string(extension)), image);
    CHECK(test::readBytes(folder / ("a" + std::string(extension))) ==
          test::readBytes(folder / ("b" + std::string(extension))));
  }
}

TEST_CASE("what cannot be written is named and leaves nothing") {
  test::TemporaryFolder folder;
  const Image8 image(4, 4, 3);
  CHECK(test::errorOf([&] { writeImage(folder / "no/such/a.png", image); }).code() == ErrorCode::io);
  CHECK(test::errorOf([&] { writeImage(folder / "a.bmp", image); }).code() == ErrorCode::unsupported);
  CHECK(test::errorOf([&] { writeImage(folder / "a.png", Image8(4, 4, 2)); }).code() == ErrorCode::unsupported);
  CHECK(test::errorOf([&] { writeImage(folder / "a.jpg", Image8(4, 4, 4)); }).code() == ErrorCode::unsupported);
  CHECK(std::filesystem::is_empty(folder.path()));
}

TEST_CASE("a header far behind its file's beginning is found") {
  test::TemporaryFolder folder;
  test::Bytes jpeg = test::makeJpeg(test::noisyPicture(24, 16, 3), test::JpegKind::baseline);
  // Six comments of 64 KiB push the frame header behind what a probe reads first.
  test::Bytes comment(65537, 'x');
  comment[0] = 0xff;
  comment[1] = 0xfe;
  comment[2] = comment[3] = 0xff;
  for (int i = 0; i < 6; ++i) jpeg.insert(jpeg.begin() + 2, comment.begin(), comment.end());
  test::writeBytes(folder / "a.jpg", jpeg);
  CHECK(probeImage(folder / "a.jpg").width == 24);
}
