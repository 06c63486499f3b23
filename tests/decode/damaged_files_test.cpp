// SPDX-License-Identifier: Apache-2.0
// Damaged files of all formats that ibr-decode reads: an error or a picture of the announced size, never an end of this
// process. Also the fuzz test of the boundary between both processes.
#include <random>

#include "encoded_files.h"
#include "io/image_file.h"

using namespace ibr;

namespace {

std::vector<std::string> seeds(const test::TemporaryFolder& folder) {
  const Image8 picture = test::smoothPicture(48, 32);
  test::writeBytes(
      folder / "a.jpg",
      test::withExifBlock(test::withJpegProfile(test::makeJpeg(picture, test::JpegKind::baseline), test::displayP3()),
                          test::cameraExif(6)));
  const std::string jpeg = (folder / "a.jpg").string();
  for (const char* name : {"a.heic", "a.avif"}) test::runEncoder({"heif-enc", "-o", (folder / name).string(), jpeg});
  test::runEncoder({"cwebp", "-quiet", "-metadata", "all", jpeg, "-o", (folder / "a.webp").string()});
  test::writeDng(folder / "a.dng", {{0.1, 0.2, 0.3}, {0.5, 0.4, 0.3}, {0.9, 0.8, 0.7}});
  return {"a.heic", "a.avif", "a.webp", "a.dng"};
}

// Reads a file that may be damaged. Returns true if it gave a picture.
bool answers(const std::filesystem::path& file) {
  try {
    const Image8 picture = readImage(file, true, {.pixels = 1 << 20});
    CHECK((picture.width > 0 && picture.height > 0 && picture.channels == 3));
    return true;
  } catch (const Error& error) {
    CHECK((error.code() == ErrorCode::invalidInput || error.code() == ErrorCode::unsupported));
    CHECK_THAT(error.what(), Catch::Contains(file.filename().string()));
    return false;
  }
}

}  // namespace

TEST_CASE("truncated files of other formats are refused", "[P1][P2]") {
  const test::TemporaryFolder folder;
  for (const std::string& name : seeds(folder)) {
    const test::Bytes whole = test::readBytes(folder / name);
    REQUIRE(answers(folder / name));
    for (const double share : {0.02, 0.3, 0.6, 0.9}) {
      const std::size_t size = std::size_t(share * double(whole.size()));
      INFO(name << " cut to " << size << " of " << whole.size());
      test::writeBytes(folder / ("cut" + name.substr(1)), test::Bytes(whole.begin(), whole.begin() + long(size)));
      CHECK_FALSE(answers(folder / ("cut" + name.substr(1))));
    }
  }
}

TEST_CASE("changed files of other formats are answered", "[P1]") {
  const test::TemporaryFolder folder;
  std::mt19937 random(1);
  for (const std::string& name : seeds(folder)) {
    const test::Bytes whole = test::readBytes(folder / name);
    for (int round = 0; round < 60; ++round) {
      test::Bytes bytes = whole;
      // Most changes in the head, where sizes and offsets are.
      const std::size_t range = round % 3 ? std::min<std::size_t>(bytes.size(), 512) : bytes.size();
      for (int change = 0; change < 1 + round % 4; ++change)
        bytes[random() % range] =
            round % 2 ? std::uint8_t(random()) : std::uint8_t(bytes[random() % range] ^ 1u << random() % 8);
      test::writeBytes(folder / ("changed" + name.substr(1)), bytes);
      INFO(name << ", round " << round);
      try {
        answers(folder / ("changed" + name.substr(1)));
      } catch (const std::exception& error) {
        FAIL(error.what());
      }
    }
  }
}
