// SPDX-License-Identifier: Apache-2.0

#include <catch2/catch.hpp>
#include <cstring>
#include <random>
#include <stop_token>

#include "base/file.h"
#include "ibr/error.h"
#include "ibr/texture.h"
#include "image/ktx2_file.h"
#include "support/error_of.h"
#include "support/temporary_folder.h"

using namespace ibr;

namespace {

std::vector<Image8> chain(int width, int height) {
  Image8 image(width, height, 4);
  std::mt19937 random(3);
  for (auto& v : image.values) v = std::uint8_t(random());
  return buildMips(image);
}

template <class T>
void poke(std::vector<std::byte>& bytes, std::size_t offset, T value) {
  std::memcpy(&bytes.at(offset), &value, sizeof value);
}

template <class T>
T peek(const std::vector<std::byte>& bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, &bytes.at(offset), sizeof value);
  return value;
}

}  // namespace

TEST_CASE("levels read back unchanged") {
  const test::TemporaryFolder folder;
  for (auto [format, vkFormat] :
       {std::pair{TextureFormat::rgba8, 43u}, {TextureFormat::bc1, 132u}, {TextureFormat::bc7, 146u}})
    for (auto [width, height] : {std::pair{64, 32}, {33, 7}, {1, 1}, {1, 9}, {640, 3}}) {
      const Texture texture = encodeTexture(chain(width, height), format);
      writeKtx2(folder / "a.ktx2", texture);
      CHECK(readKtx2(folder / "a.ktx2") == texture);
      const Ktx2Info info = probeKtx2(folder / "a.ktx2");
      CHECK(info.vkFormat == vkFormat);
      CHECK(info.format == format);
      CHECK(info.width == width);
      CHECK(info.height == height);
      CHECK(info.levels == int(texture.levels.size()));
    }
}

TEST_CASE("small levels are read without the large ones") {
  const test::TemporaryFolder folder;
  for (const auto format : {TextureFormat::rgba8, TextureFormat::bc1, TextureFormat::bc7}) {
    const std::vector<Image8> levels = chain(37, 20);
    const Texture whole = encodeTexture(levels, format);
    writeKtx2(folder / "a.ktx2", whole);
    for (std::size_t first = 0; first < levels.size(); ++first)
      CHECK(readKtx2(folder / "a.ktx2", int(first)) ==
            encodeTexture({levels.begin() + std::ptrdiff_t(first), levels.end()}, format));
    CHECK_THROWS_WITH(readKtx2(folder / "a.ktx2", int(levels.size())),
                      Catch::Contains("a.ktx2") && Catch::Contains("levelCount 6"));

    // Damage in larger levels goes unnoticed, because they are not read.
    std::vector<std::byte> bytes = readFile(folder / "a.ktx2");
    for (std::size_t i = 0; i < whole.levels[0].size(); ++i) bytes[bytes.size() - 1 - i] = std::byte(0x5A);
    writeFile(folder / "a.ktx2", bytes);
    CHECK(readKtx2(folder / "a.ktx2", 1) == encodeTexture({levels.begin() + 1, levels.end()}, format));
    CHECK_FALSE(readKtx2(folder / "a.ktx2") == whole);
  }
}

TEST_CASE("a requested stop ends the reading of a KTX file") {
  const test::TemporaryFolder folder;
  writeKtx2(folder / "a.ktx2", Texture(buildMips(Image8(4, 4, 4))));
  std::stop_source stop;
  CHECK(readKtx2(folder / "a.ktx2", 0, stop.get_token()) == readKtx2(folder / "a.ktx2"));
  stop.request_stop();
  CHECK(test::errorOf([&] { readKtx2(folder / "a.ktx2", 0, stop.get_token()); }).code() == ErrorCode::cancelled);
}

TEST_CASE("the file of a 2x1 image has the specified bytes") {
  // Written by hand from the KTX 2.0 and Data Format specifications.
  const test::TemporaryFolder folder;
  Image8 large(2, 1, 4), small(1, 1, 4);
  for (std::size_t i = 0; i < 8; ++i) large.values[i] = std::uint8_t(0x10 + i);
  for (std::size_t i = 0; i < 4; ++i) small.values[i] = std::uint8_t(0xA0 + i);
  writeKtx2(folder / "a.ktx2", std::vector{large, small});
  std::string hex;
  for (const std::byte b : readFile(folder / "a.ktx2")) {
    constexpr char kDigits[] = "0123456789abcdef";
    hex += kDigits[int(b) >> 4];
    hex += kDigits[int(b) & 15];
  }
  const std::string expected =
      "ab4b5458203230bb0d0a1a0a"          // identifier
      "2b00000001000000"                  // R8G8B8A8_SRGB, type size
      "020000000100000000000000"          // 2 × 1, no depth
      "000000000100000002000000"          // no array, one face, two levels
      "00000000"                          // no supercompression
      "800000005c000000"                  // descriptor at 128, 92 bytes
      "dc00000030000000"                  // keys at 220, 48 bytes
      "00000000000000000000000000000000"  // no global data
      "1001000000000000"
      "0800000000000000"
      "0800000000000000"  // level 0 at 272
      "0c01000000000000"
      "0400000000000000"
      "0400000000000000"  // level 1 at 268
      "5c000000"
      "00000000"
      "02005800"  // descriptor: size, Khronos basic, version 2 and 88 bytes
      "01010200"
      "00000000"
      "0400000000000000"  // RGBSDA, BT.709, sRGB; 1×1×1×1; 4 bytes in plane 0
      "00000700"
      "00000000"
      "00000000"
      "ff000000"  // red
      "08000701"
      "00000000"
      "00000000"
      "ff000000"  // green
      "10000702"
      "00000000"
      "00000000"
      "ff000000"  // blue
      "1800071f"
      "00000000"
      "00000000"
      "ff000000"  // alpha, linear
      "12000000"
      "4b54586f7269656e746174696f6e00"
      "726400"
      "0000"  // KTXorientation, rd
      "11000000"
      "4b545877726974657200"
      "6c696269627200"
      "000000"  // KTXwriter, libibr
      "a0a1a2a3"
      "1011121314151617";
  CHECK(hex == expected);
}

TEST_CASE("files of blocks have the specified descriptor and alignment") {
  // Written by hand from the Data Format Specification: one sample for the whole block; 3 for a side of 4.
  const test::TemporaryFolder folder;
  struct Expected {
    TextureFormat format;
    std::uint32_t model, blockBytes;
  };
  for (const auto& [format, model, blockBytes] :
       {Expected{TextureFormat::bc1, 128, 8}, Expected{TextureFormat::bc7, 134, 16}}) {
    const Texture texture = encodeTexture(chain(9, 5), format);
    writeKtx2(folder / "a.ktx2", texture);
    const std::vector<std::byte> bytes = readFile(folder / "a.ktx2");
    REQUIRE(texture.levels.size() == 4);
    const auto at = peek<std::uint32_t>(bytes, 48);
    CHECK(at == 80 + 4 * 24);
    CHECK(peek<std::uint32_t>(bytes, 52) == 44);
    const std::uint32_t expected[]{
        44, 0, 2 | 40u << 16, model | 1 << 8 | 2 << 16, 3 | 3 << 8, blockBytes, 0, (8 * blockBytes - 1) << 16,
        0,  0, 0xFFFFFFFF};
    for (std::size_t i = 0; i < std::size(expected); ++i) {
      INFO(i);
      CHECK(peek<std::uint32_t>(bytes, at + 4 * i) == expected[i]);
    }
    std::uint64_t after = bytes.size();
    for (std::size_t l = 0; l < 4; ++l) {
      const auto offset = peek<std::uint64_t>(bytes, 80 + 24 * l);
      CHECK(offset % blockBytes == 0);
      CHECK(offset + texture.levels[l].size() <= after);  // smallest level first
      after = offset;
    }
  }
}

TEST_CASE("a file of half floats has the specified descriptor and type size") {
  // Written by hand from the Data Format Specification: two signed 16-bit floats, linear.
  const test::TemporaryFolder folder;
  Texture texture;
  texture.format = TextureFormat::rg16f;
  texture.width = 3;
  texture.height = 2;
  for (int at = 0; at < 24; ++at) texture.levels.resize(1), texture.levels[0].push_back(std::byte(at));
  writeKtx2(folder / "a.ktx2", texture);
  CHECK(readKtx2(folder / "a.ktx2") == texture);
  CHECK(probeKtx2(folder / "a.ktx2").format == TextureFormat::rg16f);
  std::vector<std::byte> bytes = readFile(folder / "a.ktx2");
  CHECK(peek<std::uint32_t>(bytes, 12) == 83);
  CHECK(peek<std::uint32_t>(bytes, 16) == 2);
  const auto at = peek<std::uint32_t>(bytes, 48);
  CHECK(peek<std::uint32_t>(bytes, 52) == 60);
  const std::uint32_t expected[]{
      60, 0,          2 | 56u << 16, 1 | 1 << 8 | 1 << 16,         0, 4,          0,         15u << 16 | 0xC0u << 24,
      0,  0xBF800000, 0x3F800000,    16 | 15u << 16 | 0xC1u << 24, 0, 0xBF800000, 0x3F800000};
  for (std::size_t i = 0; i < std::size(expected); ++i) {
    INFO(i);
    CHECK(peek<std::uint32_t>(bytes, at + 4 * i) == expected[i]);
  }
  poke(bytes, 16, 1u);
  writeFile(folder / "a.ktx2", bytes);
  CHECK_THROWS_WITH(readKtx2(folder / "a.ktx2"), Catch::Contains("typeSize 1"));
}

TEST_CASE("the error for a faulty KTX file names file and field", "[P2][N14]") {
  const test::TemporaryFolder folder;
  writeKtx2(folder / "good.ktx2", chain(8, 4));
  const std::vector<std::byte> good = readFile(folder / "good.ktx2");
  struct Mutation {
    const char* field;
    std::size_t offset, width;
    std::uint64_t value;
    ErrorCode code;
  };
  const ErrorCode invalid = ErrorCode::invalidInput, unsupported = ErrorCode::unsupported;
  const std::uint64_t huge = ~std::uint64_t(0);
  for (const Mutation& m : {
           Mutation{"identifier", 7, 1, 0, invalid},
           {"vkFormat", 12, 4, 44, unsupported},
           {"vkFormat", 12, 4, 0, unsupported},
           {"typeSize", 16, 4, 2, invalid},
           {"pixelWidth", 20, 4, 0, invalid},
           {"pixelWidth", 20, 4, 0xFFFFFFFF, invalid},
           {"byteLength", 20, 4, 65536, invalid},
           {"byteLength", 20, 4, 9, invalid},
           {"pixelHeight", 24, 4, 0, invalid},
           {"pixelHeight", 24, 4, 65537, invalid},
           {"pixelDepth", 28, 4, 1, unsupported},
           {"layerCount", 32, 4, 1, unsupported},
           {"faceCount", 36, 4, 6, unsupported},
           {"levelCount", 40, 4, 0, invalid},
           {"levelCount", 40, 4, 5, invalid},
           {"levelCount", 40, 4, 0xFFFFFFFF, invalid},
           {"supercompressionScheme", 44, 4, 2, unsupported},
           {"dfdByteOffset", 48, 4, 0xFFFFFFF0, invalid},
           {"dfdByteOffset", 52, 4, 0xFFFFFFFF, invalid},
           {"kvdByteOffset", 56, 4, 4, invalid},
           {"kvdByteOffset", 60, 4, 0x7FFFFFFF, invalid},
           {"sgdByteLength", 72, 8, 8, invalid},
           {"levels[0].byteOffset", 80, 8, huge - 63, invalid},
           {"levels[0].byteOffset", 80, 8, 0, invalid},
           {"levels[0].byteOffset", 80, 8, peek<std::uint64_t>(good, 80) + 1, invalid},
           {"levels[0].byteOffset", 80, 8, peek<std::uint64_t>(good, 80) + 4, invalid},
           {"levels[0].byteOffset", 80, 8, peek<std::uint64_t>(good, 80) - 2, invalid},
           {"levels[1].byteLength", 80 + 24 + 8, 8, huge, invalid},
           {"levels[1].byteLength", 80 + 24 + 16, 8, 0, invalid},
       }) {
    std::vector<std::byte> bytes = good;
    std::memcpy(&bytes.at(m.offset), &m.value, m.width);
    writeFile(folder / "bad.ktx2", bytes);
    INFO(m.field << " " << m.value);
    for (const bool whole : {true, false}) try {
        whole ? void(readKtx2(folder / "bad.ktx2")) : void(probeKtx2(folder / "bad.ktx2"));
        CHECK_FALSE("nothing was thrown");
      } catch (const Error& e) {
        CHECK(e.code() == m.code);
        CHECK_THAT(e.what(), Catch::Contains("bad.ktx2") && Catch::Contains(m.field));
      }
  }
}

TEST_CASE("a KTX file truncated at any byte is refused") {
  const test::TemporaryFolder folder;
  writeKtx2(folder / "good.ktx2", chain(4, 4));
  const std::vector<std::byte> good = readFile(folder / "good.ktx2");
  for (std::size_t length = 0; length < good.size(); ++length) {
    writeFile(folder / "cut.ktx2", std::span(good).first(length));
    REQUIRE_THROWS_AS(readKtx2(folder / "cut.ktx2"), Error);
    REQUIRE_THROWS_AS(probeKtx2(folder / "cut.ktx2"), Error);
  }
  CHECK_THROWS_WITH(readKtx2(folder / "missing.ktx2"), Catch::Contains("missing.ktx2"));
}

TEST_CASE("inconsistent levels are not written") {
  const test::TemporaryFolder folder;
  const auto levels = chain(8, 4);
  const auto wrong =
      GENERATE_COPY(std::vector<Image8>{}, std::vector{Image8(8, 4, 3)}, std::vector{levels[0], levels[2]},
                    std::vector{Image8(1, 1, 4), Image8(1, 1, 4)}, std::vector{Image8()});
  CHECK_THROWS_AS(writeKtx2(folder / "a.ktx2", wrong), Error);
  Texture texture = levels;
  const auto damage = GENERATE(0, 1, 2, 3);
  if (damage == 0) texture.levels[1].pop_back();
  if (damage == 1) texture.levels.push_back(texture.levels.back());
  if (damage == 2) texture.format = TextureFormat::bc1;
  if (damage == 3) texture.height = 0;
  CHECK_THROWS_AS(writeKtx2(folder / "a.ktx2", texture), Error);
  CHECK_FALSE(std::filesystem::exists(folder / "a.ktx2"));
}
