// SPDX-License-Identifier: Apache-2.0
//
// File layout (Khronos, "KTX File Format Specification", version 2.0), little-endian:
//
//     0  identifier, vkFormat, typeSize, width, height, depth, layers, faces, levels, supercompression
//    48  offset and length of: data format descriptor, key/value data, supercompression data
//    80  per level, from the largest: offset, length, length when not supercompressed (64 bits each)
//        data format descriptor, key/value data
//        levels from the smallest, each aligned to lcm(size of a texel block, 4)
#include "ibr/texture.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstring>
#include <span>
#include <string_view>

#include "base/check.h"
#include "base/file.h"
#include "base/stop.h"
#include "image/ktx2_file.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

static_assert(std::endian::native == std::endian::little, "fields are copied without byte swapping");

constexpr std::array<std::uint8_t, 12> kIdentifier{0xAB, 'K', 'T', 'X', ' ', '2', '0', 0xBB, '\r', '\n', 0x1A, '\n'};
constexpr std::uint32_t kMaxSide = 1 << 16;  // texels; limit of validate() for photographs
constexpr std::uint32_t kMaxLevels = 17;

// Values of a format in the file: Vulkan's enumerators, and those of the Khronos Data Format Specification 1.3.
struct FileFormat {
  TextureFormat format;
  std::uint32_t written, alsoRead;  // VkFormat: sRGB and UNORM of photographs, one of depth
  std::uint32_t colourModel;
  std::uint32_t blockSide, blockBytes;
  std::uint32_t typeSize;  // bytes of a number, for the byte order
};
constexpr FileFormat kFormats[]{
    {TextureFormat::rgba8, 43, 37, 1, 1, 4, 1},
    {TextureFormat::bc1, 132, 131, 128, 4, 8, 1},
    {TextureFormat::bc7, 146, 145, 134, 4, 16, 1},
    {TextureFormat::rg16f, 83, 83, 1, 1, 4, 2},
};

const FileFormat& formatOf(TextureFormat format) {
  return *std::ranges::find(kFormats, format, &FileFormat::format);
}

const FileFormat* formatOf(std::uint32_t vkFormat) {
  const auto* found =
      std::ranges::find_if(kFormats, [&](const auto& f) { return f.written == vkFormat || f.alsoRead == vkFormat; });
  return found == std::end(kFormats) ? nullptr : found;
}

struct Header {
  std::array<std::uint8_t, 12> identifier = kIdentifier;
  std::uint32_t vkFormat = 0, typeSize = 1;
  std::uint32_t width = 0, height = 0, depth = 0, layers = 0, faces = 1, levels = 0, supercompression = 0;
  std::uint32_t descriptorOffset = 0, descriptorBytes = 0, keysOffset = 0, keysBytes = 0;
  std::uint64_t globalOffset = 0, globalBytes = 0;
};
static_assert(sizeof(Header) == 80);

struct Level {
  std::uint64_t offset = 0, bytes = 0, plainBytes = 0;
};
static_assert(sizeof(Level) == 24);

// Basic descriptor of a format: photographs have the sRGB transfer function, depth is linear.
std::vector<std::uint32_t> formatDescriptor(const FileFormat& format) {
  constexpr std::uint32_t kVersion = 2, kPrimariesBt709 = 1, kTransferLinear = 1, kTransferSrgb = 2, kAlpha = 15,
                          kLinear = 0x10, kSigned = 0x40, kFloat = 0x80;
  const bool blocks = format.blockSide > 1, halfFloats = format.format == TextureFormat::rg16f;
  const std::uint32_t transfer = halfFloats ? kTransferLinear : kTransferSrgb;
  const std::uint32_t samples = blocks       ? 1
                                : halfFloats ? 2
                                             : 4,
                      blockBytes = 24 + 16 * samples, side = format.blockSide - 1;
  std::vector<std::uint32_t> words{4 + blockBytes,
                                   0,
                                   kVersion | blockBytes << 16,
                                   format.colourModel | kPrimariesBt709 << 8 | transfer << 16,
                                   side | side << 8,
                                   format.blockBytes,
                                   0};
  // Word by word: inserting a list makes GCC 12 at -O3 warn, wrongly, of a write beyond the allocation.
  const auto addSample = [&words](std::uint32_t placeAndChannel, std::uint32_t lower, std::uint32_t upper) {
    for (const std::uint32_t word : {placeAndChannel, 0u, lower, upper}) words.push_back(word);
  };
  if (blocks) {  // all channels in one sample
    addSample((8 * format.blockBytes - 1) << 16, 0, 0xFFFFFFFF);
    return words;
  }
  if (halfFloats) {
    for (std::uint32_t c = 0; c < samples; ++c)
      addSample(16 * c | 15u << 16 | (c | kSigned | kFloat) << 24, std::bit_cast<std::uint32_t>(-1.0f),
                std::bit_cast<std::uint32_t>(1.0f));
    return words;
  }
  for (std::uint32_t c = 0; c < samples; ++c) {
    const std::uint32_t channel = c < 3 ? c : kAlpha | kLinear;
    addSample(8 * c | 7u << 16 | channel << 24, 0, 255);
  }
  return words;
}

int side(int base, std::size_t level) {
  return std::max(1, base >> level);
}

std::vector<std::byte> keyValues() {
  using namespace std::string_view_literals;
  std::vector<std::byte> bytes;
  // Key, NUL, value, NUL; sorted by key; each entry padded to 4 bytes.
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
  TextureFormat format;
  std::vector<Level> levels;
};

// Parses header and level index from the start of a file of `fileBytes` bytes.
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
  const FileFormat* format = formatOf(h.vkFormat);
  supported(format != nullptr, "vkFormat", h.vkFormat,
            "only R8G8B8A8 (43, 37), BC1_RGB (132, 131) and BC7 (146, 145), SRGB and UNORM, and R16G16_SFLOAT (83) are "
            "supported");
  result.format = format->format;
  demand(h.typeSize == format->typeSize, "typeSize", h.typeSize,
         format->typeSize == 1 ? "is not 1" : "is not 2, the size of a half float");
  demand(h.width >= 1 && h.width <= kMaxSide, "pixelWidth", h.width, "is not within 1 to 65536");
  demand(h.height >= 1 && h.height <= kMaxSide, "pixelHeight", h.height, "is not within 1 to 65536");
  supported(h.depth == 0, "pixelDepth", h.depth, "only 2D textures are supported");
  supported(h.layers == 0, "layerCount", h.layers, "texture arrays are not supported");
  supported(h.faces == 1, "faceCount", h.faces, "cube maps are not supported");
  supported(h.supercompression == 0, "supercompressionScheme", h.supercompression, "only 0 is supported");
  const auto most = std::uint32_t(std::bit_width(std::max(h.width, h.height)));
  demand(h.levels >= 1 && h.levels <= most, "levelCount", h.levels, "does not fit the image size");
  const std::uint64_t indexEnd = sizeof h + h.levels * sizeof(Level);
  check(start.size() >= indexEnd, ErrorCode::invalidInput, "{}: level index: ends after {} of {} bytes", file,
        start.size(), indexEnd);
  const auto inFile = [&](std::uint64_t offset, std::uint64_t bytes) {
    return offset >= indexEnd && offset <= fileBytes && bytes <= fileBytes - offset;
  };
  demand(inFile(h.descriptorOffset, h.descriptorBytes), "dfdByteOffset", h.descriptorOffset, "points outside the file");
  demand(h.keysBytes == 0 || inFile(h.keysOffset, h.keysBytes), "kvdByteOffset", h.keysOffset,
         "points outside the file");
  demand(h.globalBytes == 0, "sgdByteLength", h.globalBytes, "is not 0 without supercompression");
  result.levels.resize(h.levels);
  std::memcpy(result.levels.data(), &start[sizeof h], h.levels * sizeof(Level));
  for (std::size_t l = 0; l < result.levels.size(); ++l) {
    const Level& level = result.levels[l];
    const std::uint64_t wanted = textureBytes(result.format, side(int(h.width), l), side(int(h.height), l));
    check(level.bytes == wanted && level.plainBytes == wanted, ErrorCode::invalidInput,
          "{}: levels[{}].byteLength {} ({} uncompressed): is not {}, the length of {}x{} texels", file, l, level.bytes,
          level.plainBytes, wanted, side(int(h.width), l), side(int(h.height), l));
    check(inFile(level.offset, level.bytes) && level.offset % format->blockBytes == 0, ErrorCode::invalidInput,
          "{}: levels[{}].byteOffset {}: points outside the file of {} bytes, or is not a multiple of {}", file, l,
          level.offset, fileBytes, format->blockBytes);
  }
  return result;
}

Checked probe(const InputFile& file, const fs::path& path) {
  std::array<std::byte, sizeof(Header) + kMaxLevels * sizeof(Level)> buffer;
  const auto start = std::span(buffer).first(std::size_t(std::min<std::uint64_t>(buffer.size(), file.size())));
  file.read(0, start);
  return parse(start, file.size(), path);
}

}  // namespace

void writeKtx2(const fs::path& path, const Texture& texture) {
  const std::vector<std::vector<std::byte>>& levels = texture.levels;
  check(!levels.empty() && levels.size() <= kMaxLevels, ErrorCode::invalidInput, "{}: {} levels cannot be written",
        path.string(), levels.size());
  check(texture.width > 0 && texture.height > 0 &&
            levels.size() <= std::size_t(std::bit_width(unsigned(std::max(texture.width, texture.height)))),
        ErrorCode::invalidInput, "{}: {} levels do not fit {}x{}", path.string(), levels.size(), texture.width,
        texture.height);
  const FileFormat& format = formatOf(texture.format);
  Header header;
  header.vkFormat = format.written;
  header.typeSize = format.typeSize;
  header.width = std::uint32_t(texture.width);
  header.height = std::uint32_t(texture.height);
  header.levels = std::uint32_t(levels.size());
  for (std::size_t l = 0; l < levels.size(); ++l) {
    const std::uint64_t wanted = textureBytes(texture.format, side(texture.width, l), side(texture.height, l));
    check(levels[l].size() == wanted, ErrorCode::invalidInput, "{}: level {} has {} bytes, not {}", path.string(), l,
          levels[l].size(), wanted);
  }
  const std::vector<std::byte> keys = keyValues();
  const std::vector<std::uint32_t> descriptor = formatDescriptor(format);
  header.descriptorOffset = std::uint32_t(sizeof header + levels.size() * sizeof(Level));
  header.descriptorBytes = std::uint32_t(descriptor.size() * sizeof descriptor[0]);
  header.keysOffset = header.descriptorOffset + header.descriptorBytes;
  header.keysBytes = std::uint32_t(keys.size());
  std::vector<Level> index(levels.size());
  std::uint64_t end = header.keysOffset + header.keysBytes;
  for (std::size_t l = levels.size(); l-- > 0;) {
    end = (end + format.blockBytes - 1) / format.blockBytes * format.blockBytes;
    index[l] = {end, levels[l].size(), levels[l].size()};
    end += index[l].bytes;
  }
  std::vector<std::byte> bytes(end);
  put(bytes, 0, &header, sizeof header);
  put(bytes, sizeof header, index.data(), index.size() * sizeof(Level));
  put(bytes, header.descriptorOffset, descriptor.data(), header.descriptorBytes);
  put(bytes, header.keysOffset, keys.data(), keys.size());
  for (std::size_t l = 0; l < levels.size(); ++l) put(bytes, index[l].offset, levels[l].data(), index[l].bytes);
  writeFile(path, bytes);
}

Ktx2Info probeKtx2(const fs::path& path) {
  const Checked file = probe(InputFile(path), path);
  const Header& header = file.header;
  return {header.vkFormat, file.format, int(header.width), int(header.height), int(header.levels)};
}

Texture readKtx2(const fs::path& path, int firstLevel) {
  return readKtx2(path, firstLevel, {});
}

Texture readKtx2(const fs::path& path, int firstLevel, const std::stop_token& stop) {
  assert(firstLevel >= 0);
  const InputFile input(path);
  const Checked file = probe(input, path);
  const auto first = std::size_t(firstLevel);
  check(first < file.levels.size(), ErrorCode::invalidInput, "{}: levelCount {}: there is no level {}", path.string(),
        file.levels.size(), firstLevel);
  Texture texture;
  texture.format = file.format;
  texture.width = side(int(file.header.width), first);
  texture.height = side(int(file.header.height), first);
  for (std::size_t l = first; l < file.levels.size(); ++l) {
    checkStop(stop, "reading a texture");
    input.read(file.levels[l].offset, texture.levels.emplace_back(file.levels[l].bytes));
  }
  return texture;
}

}  // namespace ibr
