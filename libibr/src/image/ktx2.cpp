// SPDX-License-Identifier: Apache-2.0
//
// The file (Khronos, "KTX File Format Specification", version 2.0), little-endian:
//
//     0  identifier, vkFormat, typeSize, width, height, depth, layers, faces, levels, supercompression
//    48  offset and length of: data format descriptor, key/value data, supercompression data
//    80  per level, from the largest: offset, length, length when not supercompressed (64 bits each)
//        data format descriptor, key/value data
//        levels from the smallest, each aligned to lcm(size of a texel block, 4)
#include "image/ktx2.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <string_view>

#include "base/check.h"
#include "base/file.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

static_assert(std::endian::native == std::endian::little, "fields are copied as they lie in memory");

constexpr std::uint32_t kRgba8Unorm = 37, kRgba8Srgb = 43;  // VkFormat
constexpr std::array<std::uint8_t, 12> kIdentifier{0xAB, 'K', 'T', 'X', ' ', '2', '0', 0xBB, '\r', '\n', 0x1A, '\n'};
constexpr std::uint32_t kTexelBytes = 4;
constexpr std::uint32_t kLargestSide = 1 << 16;  // as validate() has it for photographs
constexpr std::uint32_t kMostLevels = 17;

struct Header {
  std::array<std::uint8_t, 12> identifier = kIdentifier;
  std::uint32_t vkFormat = kRgba8Srgb, typeSize = 1;
  std::uint32_t width = 0, height = 0, depth = 0, layers = 0, faces = 1, levels = 0, supercompression = 0;
  std::uint32_t descriptorOffset = 0, descriptorBytes = 0, keysOffset = 0, keysBytes = 0;
  std::uint64_t globalOffset = 0, globalBytes = 0;
};
static_assert(sizeof(Header) == 80);

struct Level {
  std::uint64_t offset = 0, bytes = 0, plainBytes = 0;
};
static_assert(sizeof(Level) == 24);

// Khronos Data Format Specification 1.3: the basic descriptor of RGBA8 with the sRGB transfer function.
std::vector<std::uint32_t> formatDescriptor() {
  constexpr std::uint32_t kChannels = 4, kBlockBytes = 24 + 16 * kChannels, kVersion = 2;
  constexpr std::uint32_t kModelRgb = 1, kPrimariesBt709 = 1, kTransferSrgb = 2, kAlpha = 15, kLinear = 0x10;
  const std::uint32_t colour = kModelRgb | kPrimariesBt709 << 8 | kTransferSrgb << 16;
  std::vector<std::uint32_t> words{4 + kBlockBytes, 0, kVersion | kBlockBytes << 16, colour, 0, kTexelBytes, 0};
  for (std::uint32_t c = 0; c < kChannels; ++c) {
    const std::uint32_t channel = c < 3 ? c : kAlpha | kLinear;
    words.insert(words.end(), {8 * c | 7u << 16 | channel << 24, 0, 0, 255});
  }
  return words;
}

int side(int base, std::size_t level) {
  return std::max(1, base >> level);
}

std::uint64_t levelBytes(const Header& header, std::size_t level) {
  return std::uint64_t(side(int(header.width), level)) * std::uint64_t(side(int(header.height), level)) * kTexelBytes;
}

std::vector<std::byte> keyValues() {
  using namespace std::string_view_literals;
  std::vector<std::byte> bytes;
  // Key, NUL, value, NUL; in order of the keys; each entry padded to 4 bytes.
  for (const std::string_view entry : {"KTXorientation\0rd\0"sv, "KTXwriter\0libibr\0"sv}) {
    const auto length = std::uint32_t(entry.size());
    const auto lengthBytes = std::as_bytes(std::span(&length, 1)), entryBytes = std::as_bytes(std::span(entry));
    bytes.insert(bytes.end(), lengthBytes.begin(), lengthBytes.end());
    bytes.insert(bytes.end(), entryBytes.begin(), entryBytes.end());
    bytes.resize((bytes.size() + 3) / 4 * 4);
  }
  return bytes;
}

void put(std::vector<std::byte>& bytes, std::size_t offset, const void* from, std::size_t count) {
  std::memcpy(&bytes[offset], from, count);
}

struct Checked {
  Header header;
  std::vector<Level> levels;
};

// The header and level index at the start of a file of `fileBytes` bytes.
Checked parse(std::span<const std::byte> start, std::uint64_t fileBytes, const fs::path& path) {
  const std::string file = path.string();
  const auto demand = [&](bool holds, const char* field, std::uint64_t value, const char* why) {
    check(holds, ErrorCode::invalidInput, "{}: {} {}: {}", file, field, value, why);
  };
  const auto supported = [&](bool holds, const char* field, std::uint64_t value, const char* why) {
    check(holds, ErrorCode::unsupported, "{}: {} {}: {}", file, field, value, why);
  };
  Checked result;
  Header& h = result.header;
  check(start.size() >= sizeof h, ErrorCode::invalidInput, "{}: {} bytes: too short for a KTX 2.0 header", file,
        fileBytes);
  std::memcpy(&h, start.data(), sizeof h);
  check(h.identifier == kIdentifier, ErrorCode::invalidInput, "{}: identifier: is not a KTX 2.0 file", file);
  supported(h.vkFormat == kRgba8Srgb || h.vkFormat == kRgba8Unorm, "vkFormat", h.vkFormat,
            "only 43 and 37, R8G8B8A8_SRGB and _UNORM, are read");
  demand(h.typeSize == 1, "typeSize", h.typeSize, "is not 1");
  demand(h.width >= 1 && h.width <= kLargestSide, "pixelWidth", h.width, "is not within 1 to 65536");
  demand(h.height >= 1 && h.height <= kLargestSide, "pixelHeight", h.height, "is not within 1 to 65536");
  supported(h.depth == 0, "pixelDepth", h.depth, "only 2D textures are read");
  supported(h.layers == 0, "layerCount", h.layers, "arrays are not read");
  supported(h.faces == 1, "faceCount", h.faces, "cubes are not read");
  supported(h.supercompression == 0, "supercompressionScheme", h.supercompression, "only 0 is read");
  const auto most = std::uint32_t(std::bit_width(std::max(h.width, h.height)));
  demand(h.levels >= 1 && h.levels <= most, "levelCount", h.levels, "does not fit the picture's size");
  const std::uint64_t indexEnd = sizeof h + h.levels * sizeof(Level);
  check(start.size() >= indexEnd, ErrorCode::invalidInput, "{}: level index: ends after {} of {} bytes", file,
        start.size(), indexEnd);
  const auto inFile = [&](std::uint64_t offset, std::uint64_t bytes) {
    return offset >= indexEnd && offset <= fileBytes && bytes <= fileBytes - offset;
  };
  demand(inFile(h.descriptorOffset, h.descriptorBytes), "dfdByteOffset", h.descriptorOffset, "leads out of the file");
  demand(h.keysBytes == 0 || inFile(h.keysOffset, h.keysBytes), "kvdByteOffset", h.keysOffset, "leads out of the file");
  demand(h.globalBytes == 0, "sgdByteLength", h.globalBytes, "is not 0 without supercompression");
  result.levels.resize(h.levels);
  std::memcpy(result.levels.data(), &start[sizeof h], h.levels * sizeof(Level));
  for (std::size_t l = 0; l < result.levels.size(); ++l) {
    const Level& level = result.levels[l];
    const std::uint64_t wanted = levelBytes(h, l);
    check(level.bytes == wanted && level.plainBytes == wanted, ErrorCode::invalidInput,
          "{}: levels[{}].byteLength {} ({} uncompressed): is not the {} of {}x{} texels", file, l, level.bytes,
          level.plainBytes, wanted, side(int(h.width), l), side(int(h.height), l));
    check(inFile(level.offset, level.bytes) && level.offset % kTexelBytes == 0, ErrorCode::invalidInput,
          "{}: levels[{}].byteOffset {}: leads out of the file of {} bytes, or is not a multiple of {}", file, l,
          level.offset, fileBytes, kTexelBytes);
  }
  return result;
}

}  // namespace

void writeKtx2(const fs::path& path, std::span<const Image8> levels) {
  check(!levels.empty() && levels.size() <= kMostLevels, ErrorCode::invalidInput, "{}: {} levels to write",
        path.string(), levels.size());
  Header header;
  header.width = std::uint32_t(levels[0].width);
  header.height = std::uint32_t(levels[0].height);
  header.levels = std::uint32_t(levels.size());
  for (std::size_t l = 0; l < levels.size(); ++l) {
    const Image8& level = levels[l];
    const int width = side(levels[0].width, l), height = side(levels[0].height, l);
    const bool redundant = l > 0 && levels[l - 1].width == 1 && levels[l - 1].height == 1;
    check(level.channels == 4 && level.width == width && level.height == height && !redundant &&
              level.values.size() == std::size_t(width) * std::size_t(height) * kTexelBytes,
          ErrorCode::invalidInput, "{}: level {} is {}x{} with {} channels, not {}x{} with 4", path.string(), l,
          level.width, level.height, level.channels, width, height);
  }
  const std::vector<std::byte> keys = keyValues();
  const std::vector<std::uint32_t> descriptor = formatDescriptor();
  header.descriptorOffset = std::uint32_t(sizeof header + levels.size() * sizeof(Level));
  header.descriptorBytes = std::uint32_t(descriptor.size() * sizeof descriptor[0]);
  header.keysOffset = header.descriptorOffset + header.descriptorBytes;
  header.keysBytes = std::uint32_t(keys.size());
  std::vector<Level> index(levels.size());
  std::uint64_t end = header.keysOffset + header.keysBytes;  // a multiple of 4, as is every level's length
  for (std::size_t l = levels.size(); l-- > 0;) {
    index[l] = {end, levels[l].values.size(), levels[l].values.size()};
    end += index[l].bytes;
  }
  std::vector<std::byte> bytes(end);
  put(bytes, 0, &header, sizeof header);
  put(bytes, sizeof header, index.data(), index.size() * sizeof(Level));
  put(bytes, header.descriptorOffset, descriptor.data(), header.descriptorBytes);
  put(bytes, header.keysOffset, keys.data(), keys.size());
  for (std::size_t l = 0; l < levels.size(); ++l) put(bytes, index[l].offset, levels[l].values.data(), index[l].bytes);
  writeFile(path, bytes);
}

Ktx2Info probeKtx2(const fs::path& path) {
  const std::vector<std::byte> start = readFileStart(path, sizeof(Header) + kMostLevels * sizeof(Level));
  std::error_code error;
  const std::uintmax_t fileBytes = fs::file_size(path, error);
  check(!error, ErrorCode::io, "{}: {}", path.string(), error.message());
  const Header header = parse(start, fileBytes, path).header;
  return {header.vkFormat, int(header.width), int(header.height), int(header.levels)};
}

std::vector<Image8> readKtx2(const fs::path& path) {
  const std::vector<std::byte> bytes = readFile(path);
  const Checked file = parse(bytes, bytes.size(), path);
  std::vector<Image8> levels;
  for (std::size_t l = 0; l < file.levels.size(); ++l) {
    levels.emplace_back(side(int(file.header.width), l), side(int(file.header.height), l), 4);
    std::memcpy(levels.back().values.data(), &bytes[file.levels[l].offset], file.levels[l].bytes);
  }
  return levels;
}

}  // namespace ibr
