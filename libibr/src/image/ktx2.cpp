// SPDX-License-Identifier: Apache-2.0
//
//   identifier, header, index | a level's place each | data format descriptor | keys and values | levels, smallest
//   first
#include "image/ktx2.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstring>
#include <string_view>

#include "base/check.h"
#include "base/file.h"

namespace ibr {
namespace {

using namespace std::string_view_literals;

static_assert(std::endian::native == std::endian::little, "files are written as they lie in memory");

constexpr std::array<unsigned char, 12> kIdentifier{0xAB, 'K', 'T', 'X', ' ', '2', '0', 0xBB, '\r', '\n', 0x1A, '\n'};
constexpr std::uint32_t kRgba8Unorm = 37, kRgba8Srgb = 43;  // VkFormat

struct Header {
  std::array<unsigned char, 12> identifier = kIdentifier;
  std::uint32_t format = kRgba8Srgb, typeSize = 1;
  std::uint32_t width = 0, height = 0, depth = 0, layers = 0, faces = 1, levels = 0, supercompression = 0;
  std::uint32_t descriptorOffset = 0, descriptorBytes = 0, keysOffset = 0, keysBytes = 0;
  std::uint64_t globalOffset = 0, globalBytes = 0;
};
static_assert(sizeof(Header) == 80);

struct LevelPlace {
  std::uint64_t offset, bytes, uncompressedBytes;
};

// Khronos Data Format descriptor of RGBA8 with the sRGB transfer function, as 32-bit words.
std::vector<std::uint32_t> formatDescriptor() {
  constexpr std::uint32_t kChannels = 4, kBlockBytes = 24 + 16 * kChannels;
  constexpr std::uint32_t kModelRgb = 1, kPrimariesBt709 = 1, kTransferSrgb = 2, kAlpha = 15, kLinear = 0x10;
  std::vector<std::uint32_t> words{
      4 + kBlockBytes, 0, 2 | kBlockBytes << 16, kModelRgb | kPrimariesBt709 << 8 | kTransferSrgb << 16, 0, 4, 0};
  for (std::uint32_t c = 0; c < kChannels; ++c) {
    const std::uint32_t channel = c < 3 ? c : kAlpha | kLinear;
    words.insert(words.end(), {8 * c | 7u << 16 | channel << 24, 0, 0, 255});
  }
  return words;
}

void append(std::vector<std::byte>& bytes, const void* data, std::size_t size) {
  const auto* const first = static_cast<const std::byte*>(data);
  bytes.insert(bytes.end(), first, first + size);
}

void pad(std::vector<std::byte>& bytes) {
  bytes.resize((bytes.size() + 3) & ~std::size_t(3));
}

void appendKey(std::vector<std::byte>& bytes, std::string_view keyAndValue) {
  const auto size = std::uint32_t(keyAndValue.size());
  append(bytes, &size, sizeof size);
  append(bytes, keyAndValue.data(), keyAndValue.size());
  pad(bytes);
}

}  // namespace

void writeKtx2(const std::filesystem::path& path, std::span<const Image8> levels) {
  assert(!levels.empty() && levels[0].channels == 4);
  Header header;
  header.width = std::uint32_t(levels[0].width);
  header.height = std::uint32_t(levels[0].height);
  header.levels = std::uint32_t(levels.size());
  std::vector<LevelPlace> places(levels.size());
  std::vector<std::byte> bytes(sizeof header + places.size() * sizeof(LevelPlace));

  const std::vector<std::uint32_t> descriptor = formatDescriptor();
  header.descriptorOffset = std::uint32_t(bytes.size());
  header.descriptorBytes = std::uint32_t(descriptor.size() * 4);
  append(bytes, descriptor.data(), header.descriptorBytes);
  header.keysOffset = std::uint32_t(bytes.size());
  appendKey(bytes, "KTXorientation\0rd\0"sv);
  appendKey(bytes, "KTXwriter\0libibr\0"sv);
  header.keysBytes = std::uint32_t(bytes.size()) - header.keysOffset;
  for (std::size_t l = levels.size(); l-- > 0;) {
    const std::size_t size = levels[l].values.size();
    places[l] = {bytes.size(), size, size};
    append(bytes, levels[l].values.data(), size);
    pad(bytes);
  }
  std::memcpy(bytes.data(), &header, sizeof header);
  std::memcpy(bytes.data() + sizeof header, places.data(), places.size() * sizeof places[0]);
  writeFile(path, bytes);
}

std::vector<Image8> readKtx2(const std::filesystem::path& path) {
  const std::vector<std::byte> bytes = readFile(path);
  const auto demand = [&](bool holds, ErrorCode code, std::string_view field, std::uint64_t value) {
    check(holds, code, "{}: {} {} is not possible or not supported", path.string(), field, value);
  };
  Header header;
  check(bytes.size() >= sizeof header, ErrorCode::invalidInput, "{}: ends within the header, after {} bytes",
        path.string(), bytes.size());
  std::memcpy(&header, bytes.data(), sizeof header);
  check(header.identifier == kIdentifier, ErrorCode::invalidInput, "{}: is not a KTX 2.0 file", path.string());
  demand(header.format == kRgba8Srgb || header.format == kRgba8Unorm, ErrorCode::unsupported, "vkFormat",
         header.format);
  demand(header.typeSize == 1, ErrorCode::invalidInput, "typeSize", header.typeSize);
  constexpr std::uint32_t kLargest = 1 << 16;
  demand(header.width >= 1 && header.width <= kLargest, ErrorCode::invalidInput, "pixelWidth", header.width);
  demand(header.height >= 1 && header.height <= kLargest, ErrorCode::invalidInput, "pixelHeight", header.height);
  demand(header.depth == 0, ErrorCode::unsupported, "pixelDepth", header.depth);
  demand(header.layers == 0, ErrorCode::unsupported, "layerCount", header.layers);
  demand(header.faces == 1, ErrorCode::unsupported, "faceCount", header.faces);
  demand(header.supercompression == 0, ErrorCode::unsupported, "supercompressionScheme", header.supercompression);
  const auto longest = std::uint32_t(std::bit_width(std::max(header.width, header.height)));
  demand(header.levels >= 1 && header.levels <= longest, ErrorCode::invalidInput, "levelCount", header.levels);
  check(bytes.size() >= sizeof header + header.levels * sizeof(LevelPlace), ErrorCode::invalidInput,
        "{}: ends within the level index", path.string());

  std::vector<Image8> levels;
  for (std::uint32_t l = 0; l < header.levels; ++l) {
    LevelPlace place;
    std::memcpy(&place, bytes.data() + sizeof header + l * sizeof place, sizeof place);
    const auto width = std::max(header.width >> l, 1u), height = std::max(header.height >> l, 1u);
    check(place.bytes == std::uint64_t(width) * height * 4, ErrorCode::invalidInput,
          "{}: level {} of {}x{} has a byteLength of {}", path.string(), l, width, height, place.bytes);
    check(place.offset <= bytes.size() && place.bytes <= bytes.size() - place.offset, ErrorCode::invalidInput,
          "{}: level {} lies beyond the file's {} bytes", path.string(), l, bytes.size());
    Image8& level = levels.emplace_back(int(width), int(height), 4);
    std::memcpy(level.values.data(), bytes.data() + place.offset, place.bytes);
  }
  return levels;
}

}  // namespace ibr
