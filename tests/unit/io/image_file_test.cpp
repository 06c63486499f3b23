// SPDX-License-Identifier: Apache-2.0
#include "io/image_file.h"

#include "base/file.h"
#include "support/temporary_folder.h"
#include "unusual_files.h"

using namespace ibr;

TEST_CASE("PNG keeps every value, also of narrow images") {
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

TEST_CASE("JPEG keeps the size of narrow images") {
  test::TemporaryFolder folder;
  const std::pair<int, int> sizes[] = {{1, 1}, {1, 40}, {40, 1}, {17, 9}};
  for (const auto& [width, height] : sizes) {
    writeImage(folder / "a.jpg", Image8(width, height, 3, 90));
    CHECK(readImage(folder / "a.jpg") == Image8(width, height, 3, 90));
  }
}

TEST_CASE("a higher JPEG quality gives a larger file with small errors") {
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

TEST_CASE("the same image gives the same bytes") {
  test::TemporaryFolder folder;
  const Image8 image = test::noisyPicture(50, 30, 3);
  for (const char* extension : {".png", ".jpg"}) {
    writeImage(folder / ("a" + std::string(extension)), image);
    writeImage(folder / ("b" + std::string(extension)), image);
    CHECK(test::readBytes(folder / ("a" + std::string(extension))) ==
          test::readBytes(folder / ("b" + std::string(extension))));
  }
}

TEST_CASE("an image that cannot be written throws and leaves no file") {
  test::TemporaryFolder folder;
  const Image8 image(4, 4, 3);
  CHECK(test::errorOf([&] { writeImage(folder / "no/such/a.png", image); }).code() == ErrorCode::io);
  CHECK(test::errorOf([&] { writeImage(folder / "a.bmp", image); }).code() == ErrorCode::unsupported);
  CHECK(test::errorOf([&] { writeImage(folder / "a.png", Image8(4, 4, 2)); }).code() == ErrorCode::unsupported);
  CHECK(test::errorOf([&] { writeImage(folder / "a.jpg", Image8(4, 4, 4)); }).code() == ErrorCode::unsupported);
  CHECK(std::filesystem::is_empty(folder.path()));
}

TEST_CASE("a JPEG header far from the start of the file is found") {
  test::TemporaryFolder folder;
  test::Bytes jpeg = test::makeJpeg(test::noisyPicture(24, 16, 3), test::JpegKind::baseline);
  // Six comments of 64 KiB move the frame header beyond the part that a probe reads first.
  test::Bytes comment(65537, 'x');
  comment[0] = 0xff;
  comment[1] = 0xfe;
  comment[2] = comment[3] = 0xff;
  for (int i = 0; i < 6; ++i) jpeg.insert(jpeg.begin() + 2, comment.begin(), comment.end());
  test::writeBytes(folder / "a.jpg", jpeg);
  CHECK(probeImage(folder / "a.jpg").width == 24);
}

TEST_CASE("PNG texts read back unchanged and do not change the pixels") {
  test::TemporaryFolder folder;
  const Image8 image = test::noisyPicture(40, 30, 4);
  const std::vector<ImageText> texts{
      {"Title", "plain"}, {"empty", ""}, {"wide", "η, 你好, ü"}, {"long", std::string(100000, 'x')}};
  writeImage(folder / "a.png", image, texts);
  writeImage(folder / "b.png", image, texts);
  CHECK(readImageTexts(folder / "a.png") == texts);
  CHECK(test::readBytes(folder / "a.png") == test::readBytes(folder / "b.png"));
  writeImage(folder / "bare.png", image);
  CHECK(readImage(folder / "a.png") == readImage(folder / "bare.png"));
  CHECK(readImageTexts(folder / "bare.png").empty());
  writeImage(folder / "none.png", image, std::vector<ImageText>());
  CHECK(test::readBytes(folder / "none.png") == test::readBytes(folder / "bare.png"));
  writeImage(folder / "a.jpg", Image8(8, 8, 3));
  CHECK(readImageTexts(folder / "a.jpg").empty());
}

TEST_CASE("invalid PNG texts are not written, and damaged ones are not read") {
  test::TemporaryFolder folder;
  const Image8 image(4, 4, 3);
  const std::vector<ImageText> wrong[] = {{{"", "x"}},
                                          {{" a", "x"}},
                                          {{"a ", "x"}},
                                          {{"a  b", "x"}},
                                          {{std::string(80, 'k'), "x"}},
                                          {{"a\nb", "x"}},
                                          {{"\xc3\xbc", "x"}},
                                          {{"a", std::string("x\0y", 3)}}};
  for (const auto& texts : wrong)
    CHECK(test::errorOf([&] { writeImage(folder / "a.png", image, texts); }).code() == ErrorCode::invalidInput);
  const std::vector<ImageText> fine{{"a", "x"}};
  CHECK(test::errorOf([&] { writeImage(folder / "a.jpg", image, fine); }).code() == ErrorCode::unsupported);
  CHECK(!std::filesystem::exists(folder / "a.png"));

  writeImage(folder / "a.png", image, {{"first", "one"}, {"second", "two"}});
  auto bytes = readFile(folder / "a.png");
  const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  bytes[text.find("two")] = std::byte('T');
  writeFile(folder / "a.png", bytes);
  CHECK(readImageTexts(folder / "a.png") == std::vector<ImageText>{{"first", "one"}});
  CHECK(readImage(folder / "a.png") == image);
}

TEST_CASE("image files are recognised by their first bytes") {
  test::TemporaryFolder folder;
  writeImage(folder / "a.png", Image8(1, 1, 3));
  writeImage(folder / "b.jpg", Image8(1, 1, 3));
  CHECK(isImageFile(folder / "a.png"));
  CHECK(isImageFile(folder / "b.jpg"));
  writeFile(folder / "c.png", std::string_view("{}"));
  writeFile(folder / "d.png", std::string_view(""));
  CHECK(!isImageFile(folder / "c.png"));
  CHECK(!isImageFile(folder / "d.png"));
  CHECK(!isImageFile(folder / "no.png"));
  CHECK(!isImageFile(folder / ""));
}
