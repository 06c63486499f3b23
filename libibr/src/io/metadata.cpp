// SPDX-License-Identifier: Apache-2.0
// JPEG: ITU-T T.81 annex B, segments by markers. PNG 1.2 chapter 3: chunks.
#include "io/metadata.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <set>
#include <string_view>

#include "base/check.h"
#include "base/file.h"
#include "io/exif.h"

namespace ibr {
namespace {

using Bytes = std::span<const std::byte>;
using namespace std::string_view_literals;

constexpr std::string_view kExif = "Exif\0\0"sv, kIcc = "ICC_PROFILE\0"sv, kPngMagic = "\x89PNG\r\n\x1a\n"sv;

std::uint32_t bigEndian(Bytes bytes) {
  std::uint32_t value = 0;
  for (const std::byte b : bytes) value = value << 8 | std::to_integer<std::uint32_t>(b);
  return value;
}

bool startsWith(Bytes bytes, std::string_view text) {
  return bytes.size() >= text.size() &&
         std::equal(text.begin(), text.end(), bytes.begin(), [](char c, std::byte b) { return std::byte(c) == b; });
}

void append(std::vector<std::byte>& to, Bytes bytes) {
  to.insert(to.end(), bytes.begin(), bytes.end());
}

// Calls `part(marker, payload, whole)` for each segment of a JPEG file; the part of a scan's marker holds the coded
// data that follow. Returns the number of bytes up to the end of the picture: cameras append previews and videos.
template <class F>
std::size_t jpegParts(Bytes file, const std::string& name, F&& part) {
  const auto demand = [&](bool valid) {
    check(valid, ErrorCode::invalidInput, "{}: the JPEG file is damaged or incomplete", name);
  };
  std::size_t at = 2;
  for (;;) {
    const std::size_t begin = at;
    demand(at + 2 <= file.size() && file[at] == std::byte(0xff));
    while (at + 1 < file.size() && file[at + 1] == std::byte(0xff)) ++at;  // fill bytes
    demand(at + 2 <= file.size());
    const auto marker = std::to_integer<std::uint8_t>(file[at + 1]);
    at += 2;
    if (marker == 0xd9) {
      part(marker, Bytes(), file.subspan(begin, at - begin));
      return at;
    }
    demand(at + 2 <= file.size());
    const std::size_t length = bigEndian(file.subspan(at, 2));
    demand(length >= 2 && length <= file.size() - at);
    const Bytes payload = file.subspan(at + 2, length - 2);
    at += length;
    constexpr std::uint8_t kScan = 0xda;
    if (marker == kScan)  // up to the next marker that is neither a stuffed byte nor a restart
      for (; at + 1 < file.size(); ++at) {
        const auto next = std::to_integer<std::uint8_t>(file[at + 1]);
        if (file[at] == std::byte(0xff) && next != 0 && next != 0xff && (next < 0xd0 || next > 0xd7)) break;
      }
    part(marker, payload, file.subspan(begin, at - begin));
  }
}

// Calls `part(type, payload, whole)` for each chunk of a PNG file.
template <class F>
void pngParts(Bytes file, const std::string& name, F&& part) {
  std::size_t at = kPngMagic.size();
  for (bool ended = false; !ended;) {
    constexpr std::size_t kAround = 12;  // length, type, checksum
    const bool whole = file.size() - at >= kAround && bigEndian(file.subspan(at, 4)) <= file.size() - at - kAround;
    check(whole, ErrorCode::invalidInput, "{}: the PNG file is damaged or incomplete", name);
    const std::size_t length = bigEndian(file.subspan(at, 4));
    const std::string_view type(reinterpret_cast<const char*>(file.data() + at + 4), 4);
    part(type, file.subspan(at + 8, length), file.subspan(at, kAround + length));
    ended = type == "IEND";
    at += kAround + length;
  }
}

bool isJpegFile(Bytes file) {
  return startsWith(file, "\xff\xd8\xff");
}

// An EXIF block that states nothing but the orientation.
std::vector<std::byte> orientationBlock(int orientation) {
  std::vector<std::byte> block;
  const std::string_view text("II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\0\0\0\0\0\0\0\0", 26);
  for (const char c : text) block.push_back(std::byte(c));
  block[18] = std::byte(orientation);
  return block;
}

std::vector<std::byte> jpegWithoutMetadata(Bytes file, const std::string& name) {
  std::vector<std::byte> result(file.begin(), file.begin() + 2);
  int orientation = 1;
  std::size_t head = 0;  // end of the segments that must be first
  jpegParts(file, name, [&](std::uint8_t marker, Bytes payload, Bytes whole) {
    constexpr std::uint8_t kFirst = 0xe0, kExifOrXmp = 0xe1, kProfile = 0xe2, kAdobe = 0xee, kLast = 0xef,
                           kComment = 0xfe;
    const bool application = marker >= kFirst && marker <= kLast;
    const bool kept = marker == kFirst || marker == kAdobe || (marker == kProfile && startsWith(payload, kIcc));
    if (marker == kExifOrXmp && startsWith(payload, kExif))
      orientation = io::readExif(payload.subspan(kExif.size())).orientation;
    if ((application && !kept) || marker == kComment) return;
    append(result, whole);
    if (marker == kFirst && head == 0) head = result.size();
  });
  if (orientation == 1) return result;
  const std::vector<std::byte> block = orientationBlock(orientation);
  const std::size_t length = 2 + kExif.size() + block.size();
  std::vector<std::byte> segment{std::byte(0xff), std::byte(0xe1), std::byte(length >> 8), std::byte(length & 0xff)};
  for (const char c : kExif) segment.push_back(std::byte(c));
  append(segment, block);
  result.insert(result.begin() + std::ptrdiff_t(std::max<std::size_t>(head, 2)), segment.begin(), segment.end());
  return result;
}

std::vector<std::byte> chunk(std::string_view type, Bytes payload) {
  std::vector<std::byte> result;
  const auto number = [&](std::uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8) result.push_back(std::byte(value >> shift & 0xff));
  };
  number(std::uint32_t(payload.size()));
  for (const char c : type) result.push_back(std::byte(c));
  append(result, payload);
  const Bytes checked = Bytes(result).subspan(4);
  number(std::uint32_t(::crc32(0, reinterpret_cast<const Bytef*>(checked.data()), uInt(checked.size()))));
  return result;
}

std::vector<std::byte> pngWithoutMetadata(Bytes file, const std::string& name) {
  constexpr std::array kColour{"tRNS"sv, "gAMA"sv, "cHRM"sv, "sRGB"sv, "iCCP"sv, "sBIT"sv, "cICP"sv};
  std::vector<std::byte> result(file.begin(), file.begin() + std::ptrdiff_t(kPngMagic.size()));
  int orientation = 1;
  std::size_t head = 0;  // end of the header, after which an EXIF chunk may stand
  pngParts(file, name, [&](std::string_view type, Bytes payload, Bytes whole) {
    const bool critical = type[0] >= 'A' && type[0] <= 'Z';
    if (type == "eXIf") orientation = io::readExif(payload).orientation;
    if (critical || std::ranges::find(kColour, type) != kColour.end()) append(result, whole);
    if (type == "IHDR") head = result.size();
  });
  if (orientation == 1) return result;
  const std::vector<std::byte> exif = chunk("eXIf", orientationBlock(orientation));
  result.insert(result.begin() + std::ptrdiff_t(head), exif.begin(), exif.end());
  return result;
}

void exifKinds(Bytes block, std::set<std::string>& kinds) {
  for (const io::ExifTag tag : io::exifTags(block)) {
    switch (tag.number) {
      case 0x010f:
      case 0x0110:
      case 0xa433:
      case 0xa434:
      case 0x0131:
        kinds.insert("camera");
        break;
      case 0x829a:
      case 0x829d:
      case 0x8827:
      case 0x920a:
      case 0xa405:
      case 0x9204:
      case 0x9207:
      case 0x9209:
        kinds.insert("exposure");
        break;
      case 0x0132:
      case 0x9003:
      case 0x9004:
      case 0x9010:
      case 0x9011:
      case 0x9012:
      case 0x9290:
      case 0x9291:
      case 0x9292:
        kinds.insert("time");
        break;
      case 0x8825:
        kinds.insert("location");
        break;
      case 0xa431:
      case 0xa435:
      case 0xa420:
        kinds.insert("serial number");
        break;
      case 0x013b:
      case 0x8298:
      case 0xa430:
      case 0x9c9d:
        kinds.insert("names");
        break;
      case 0x927c:
        kinds.insert("maker note");
        break;
      case 0x9286:
      case 0x010e:
      case 0x9c9b:
      case 0x9c9c:
        kinds.insert("comment");
        break;
      default:
        if (tag.preview) kinds.insert("preview image");
    }
  }
}

}  // namespace

std::vector<std::string> metadataKinds(const std::filesystem::path& path) {
  const std::vector<std::byte> file = readFile(path);
  std::set<std::string> kinds;
  try {
    if (isJpegFile(file)) {
      const std::size_t end = jpegParts(file, path.string(), [&](std::uint8_t marker, Bytes payload, Bytes) {
        if (marker == 0xe1 && startsWith(payload, kExif))
          exifKinds(payload.subspan(kExif.size()), kinds);
        else if (marker == 0xe1)
          kinds.insert("editing history (XMP)");
        else if (marker == 0xfe)
          kinds.insert("comment");
        else if (marker >= 0xe1 && marker <= 0xef && marker != 0xee && !(marker == 0xe2 && startsWith(payload, kIcc)))
          kinds.insert("other data");
      });
      if (end < file.size()) kinds.insert("other data");
    } else if (startsWith(file, kPngMagic)) {
      pngParts(file, path.string(), [&](std::string_view type, Bytes payload, Bytes) {
        if (type == "eXIf") exifKinds(payload, kinds);
        if (type == "tEXt" || type == "zTXt" || type == "iTXt") kinds.insert("comment");
        if (type == "tIME") kinds.insert("time");
      });
    }
  } catch (const Error& error) {
    if (error.code() != ErrorCode::invalidInput) throw;
    return {};
  }
  return {kinds.begin(), kinds.end()};
}

std::vector<std::byte> withoutMetadata(Bytes file, const std::string& name) {
  if (isJpegFile(file)) return jpegWithoutMetadata(file, name);
  check(startsWith(file, kPngMagic), ErrorCode::unsupported, "{}: metadata can be removed from JPEG and PNG files only",
        name);
  return pngWithoutMetadata(file, name);
}

}  // namespace ibr
