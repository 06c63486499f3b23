// SPDX-License-Identifier: Apache-2.0
// What libibr accepts from ibr-decode: the program may have been taken over by a hostile file.
#include <csignal>
#include <cstdlib>
#include <cstring>

#include "base/file.h"
#include "encoded_files.h"
#include "io/decoded.h"
#include "support/locale.h"

using namespace ibr;

namespace {

/// Runs a script instead of ibr-decode.
class OtherDecoder {
 public:
  OtherDecoder(const test::TemporaryFolder& folder, const std::string& script) : before_(std::getenv("IBR_DECODER")) {
    const std::filesystem::path file = folder / "decoder";
    writeFile(file, "#!/bin/sh\n" + script);
    std::filesystem::permissions(file, std::filesystem::perms::owner_all);
    ::setenv("IBR_DECODER", file.c_str(), 1);
  }
  explicit OtherDecoder(const char* program) : before_(std::getenv("IBR_DECODER")) {
    ::setenv("IBR_DECODER", program, 1);
  }
  ~OtherDecoder() { ::setenv("IBR_DECODER", before_.c_str(), 1); }

 private:
  std::string before_;
};

std::vector<std::byte> headerBytes(io::DecodedHeader header) {
  std::vector<std::byte> bytes(sizeof(header));
  std::memcpy(bytes.data(), &header, sizeof(header));
  return bytes;
}

ImageFileInfo infoOf(const io::DecodedHeader& header) {
  return io::infoOf(headerBytes(header), ImageFormat::heic, "a.heic");
}

void writeWebp(const test::TemporaryFolder& folder) {
  writeImage(folder / "a.png", test::smoothPicture(24, 16));
  test::runEncoder({"cwebp", "-quiet", (folder / "a.png").string(), "-o", (folder / "a.webp").string()});
}

}  // namespace

TEST_CASE("a header is read as it was made") {
  ImageFileInfo info;
  info.width = 40;
  info.height = 30;
  info.channels = 3;
  info.bitsPerChannel = 10;
  info.orientation = 6;
  info.capture = {0.01, 2.8, 100, 35, 52, "Maker", "Model", "Lens"};
  const ImageFileInfo read = infoOf(io::headerOf(info));
  CHECK((read.width == 40 && read.height == 30 && read.bitsPerChannel == 10 && read.orientation == 6));
  CHECK(read.capture == info.capture);
}

TEST_CASE("values of a hostile header are refused or replaced") {
  io::DecodedHeader good;
  good.width = good.height = 8;
  REQUIRE_NOTHROW(infoOf(good));
  for (const std::uint32_t side : {0u, 65537u, ~0u}) {
    io::DecodedHeader header = good;
    header.width = side;
    CHECK(test::errorOf([&] { infoOf(header); }).code() == ErrorCode::invalidInput);
  }
  io::DecodedHeader header = good;
  header.magic[0] = 'x';
  CHECK(test::errorOf([&] { infoOf(header); }).code() == ErrorCode::invalidInput);
  header = good;
  header.orientation = 77;
  header.exposureTime = -1;
  header.iso = std::numeric_limits<double>::quiet_NaN();
  header.focalLength = std::numeric_limits<double>::infinity();
  header.maker.fill('\x1b');  // not ended
  const ImageFileInfo info = infoOf(header);
  CHECK(info.orientation == 1);
  CHECK((info.capture.exposureTime == 0 && info.capture.iso == 0 && info.capture.focalLength == 0));
  CHECK(info.capture.maker == std::string(64, '?'));
}

TEST_CASE("a program that writes too little, too much or nonsense gives an error that names the file") {
  const test::TemporaryFolder folder;
  writeWebp(folder);
  io::DecodedHeader header;
  header.width = header.height = 8;
  writeFile(folder / "header", headerBytes(header));
  const std::string cat = "cat " + (folder / "header").string() + "\n";
  for (const std::string& script :
       {std::string("exit 0\n"), std::string("echo nonsense\n"), cat, cat + "head -c 100 /dev/zero\n",
        cat + "head -c 193 /dev/zero\n", cat + "cat /dev/zero\n", cat + "head -c 192 /dev/zero\nexit 1\n",
        cat + "head -c 192 /dev/zero\nkill -9 $$\n"}) {
    INFO(script);
    const OtherDecoder other(folder, script);
    const Error error = test::errorOf([&] { readImage(folder / "a.webp"); });
    CHECK(error.code() == ErrorCode::invalidInput);
    CHECK_THAT(error.what(), Catch::Contains("a.webp"));
  }
  const OtherDecoder right(folder, cat + "head -c 192 /dev/zero\n");
  CHECK(readImage(folder / "a.webp") == Image8(8, 8, 3, 0));
}

TEST_CASE("sizes over the limits are refused before memory is taken for them") {
  const test::TemporaryFolder folder;
  writeWebp(folder);
  CHECK_NOTHROW(readImage(folder / "a.webp", false, {.pixels = 24 * 16}));
  CHECK(test::errorOf([&] { readImage(folder / "a.webp", false, {.pixels = 24 * 16 - 1}); }).code() ==
        ErrorCode::invalidInput);
  io::DecodedHeader header;
  header.width = header.height = 65536;
  writeFile(folder / "header", headerBytes(header));
  const OtherDecoder other(folder, "cat " + (folder / "header").string() + "\ncat /dev/zero\n");
  CHECK(test::errorOf([&] { readImage(folder / "a.webp"); }).code() == ErrorCode::invalidInput);
}

TEST_CASE("a message of the program is passed on") {
  const test::TemporaryFolder folder;
  writeWebp(folder);
  const OtherDecoder other(folder, "echo 'first' >&2; echo 'the reason' >&2; exit 3\n");
  const Error error = test::errorOf([&] { readImage(folder / "a.webp"); });
  CHECK(error.code() == ErrorCode::unsupported);
  CHECK_THAT(error.what(), Catch::Contains("a.webp: the reason"));
}

TEST_CASE("a missing program is named, and what to do") {
  const test::TemporaryFolder folder;
  writeWebp(folder);
  const OtherDecoder none((folder / "missing").c_str());
  for (const bool probe : {true, false}) {
    const Error error = test::errorOf([&] {
      if (probe)
        probeImage(folder / "a.webp");
      else
        readImage(folder / "a.webp");
    });
    CHECK(error.code() == ErrorCode::io);
    CHECK_THAT(error.what(), Catch::Contains("a.webp") && Catch::Contains("WebP") && Catch::Contains("ibr-decode"));
  }
}
