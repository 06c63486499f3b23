// SPDX-License-Identifier: Apache-2.0
#include "io/decoded.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <vector>

#include "base/check.h"
#include "base/child_process.h"
#include "io/exif.h"

namespace ibr::io {
namespace fs = std::filesystem;
namespace {

constexpr const char* kProgram = "ibr-decode";
constexpr int kLargestSide = 1 << 16;  // of any picture

template <std::size_t N>
void copyText(const std::string& text, std::array<char, N>& to) {
  to.fill(0);
  std::copy_n(text.begin(), std::min(text.size(), N - 1), to.begin());
}

// Printable ASCII up to the first zero.
template <std::size_t N>
std::string textOf(const std::array<char, N>& from) {
  std::string text(from.begin(), std::find(from.begin(), from.end(), '\0'));
  for (char& c : text)
    if (c < ' ' || c > '~') c = '?';
  return text;
}

double positive(double value) {
  return std::isfinite(value) && value > 0 ? value : 0;
}

std::string decoderProgram() {
  if (const char* const given = std::getenv("IBR_DECODER"); given && *given) return given;
  std::error_code ignored;
  const fs::path beside = fs::read_symlink("/proc/self/exe", ignored).parent_path() / kProgram;
  return fs::is_regular_file(beside, ignored) ? beside.string() : kProgram;
}

// The reason that the program gave or that its end tells.
std::string reasonOf(const ChildOutput& output, bool late) {
  constexpr int kUnknownProgram = 127, kKilled = 128;
  const std::size_t end = output.lastWords.find_last_not_of("\r\n ");
  const std::string words = end == std::string::npos ? "" : output.lastWords.substr(0, end + 1);
  const std::string last = words.substr(words.find_last_of("\r\n") + 1);
  if (late) return "decoding takes too long";
  if (output.status >= kKilled) return fmt::format("{} ended by signal {}", kProgram, output.status - kKilled);
  if (output.status == kUnknownProgram && last.empty()) return fmt::format("{} cannot be run", kProgram);
  return last.empty() ? fmt::format("{} ended with status {}", kProgram, output.status) : last;
}

// Runs the program on a file. `pixels`: largest number of pixels it may decode; 0: header only. Returns the properties
// and fills `rows`.
ImageFileInfo decode(Bytes file, const std::string& name, const ReadLimits& limits, std::vector<std::uint8_t>* rows) {
  using namespace std::chrono;
  constexpr auto kPatience = minutes(10);  // the program limits its processor time itself
  const auto format = programFormat(file);
  check(format.has_value(), ErrorCode::invalidInput, "{}: is none of HEIC, AVIF, WebP and raw", name);
  std::vector<std::byte> header;
  std::optional<ImageFileInfo> info;
  std::size_t filled = 0;
  const auto take = [&](std::span<const std::byte> piece) {
    const std::size_t more = std::min(piece.size(), sizeof(DecodedHeader) - header.size());
    header.insert(header.end(), piece.begin(), piece.begin() + std::ptrdiff_t(more));
    piece = piece.subspan(more);
    if (!info && header.size() == sizeof(DecodedHeader)) {
      info = infoOf(header, *format, name);
      checkSize(*info, limits, name);
      if (rows) rows->resize(std::size_t(info->width) * std::size_t(info->height) * 3);
    }
    if (piece.empty()) return true;
    if (!rows || piece.size() > rows->size() - filled) return false;
    std::memcpy(rows->data() + filled, piece.data(), piece.size());
    filled += piece.size();
    return true;
  };
  const auto until = steady_clock::now() + kPatience;
  const ChildOutput output = [&] {
    try {
      return readChild({decoderProgram(), rows ? "picture" : "probe", std::to_string(limits.pixels)}, file, take,
                       [&] { return steady_clock::now() < until; });
    } catch (const Error& error) {
      if (error.code() != ErrorCode::io) throw;
      fail(ErrorCode::io,
           "{}: {} files are read by the program {}, which cannot be run ({}): install it beside this "
           "program or in PATH, or set IBR_DECODER",
           name, formatName(*format), kProgram, error.what());
    }
  }();
  constexpr int kUnsupported = 3;  // exit status of ibr-decode
  const bool late = steady_clock::now() >= until;
  check(output.status == 0 && !output.stopped,
        output.status == kUnsupported ? ErrorCode::unsupported : ErrorCode::invalidInput, "{}: {}", name,
        reasonOf(output, late));
  check(info && (!rows || filled == rows->size()), ErrorCode::invalidInput, "{}: {} gave an incomplete picture", name,
        kProgram);
  return *info;
}

}  // namespace

DecodedHeader headerOf(const ImageFileInfo& info) {
  DecodedHeader header;
  header.width = std::uint32_t(info.width);
  header.height = std::uint32_t(info.height);
  header.bitsPerChannel = std::uint32_t(info.bitsPerChannel);
  header.orientation = std::uint32_t(info.orientation);
  const CaptureMetadata& c = info.capture;
  header.exposureTime = c.exposureTime;
  header.fNumber = c.fNumber;
  header.iso = c.iso;
  header.focalLength = c.focalLength;
  header.focalLength35 = c.focalLength35;
  copyText(c.maker, header.maker);
  copyText(c.model, header.model);
  copyText(c.lens, header.lens);
  return header;
}

ImageFileInfo infoOf(std::span<const std::byte> bytes, ImageFormat format, const std::string& name) {
  DecodedHeader header;
  check(bytes.size() >= sizeof(header), ErrorCode::invalidInput, "{}: {} gave an incomplete header", name, kProgram);
  std::memcpy(&header, bytes.data(), sizeof(header));
  check(header.magic == DecodedHeader::kMagic, ErrorCode::invalidInput, "{}: {} is of another version", name, kProgram);
  const auto isSide = [](std::uint32_t side) { return side >= 1 && side <= kLargestSide; };
  check(isSide(header.width) && isSide(header.height), ErrorCode::invalidInput, "{}: {}×{} pixels", name, header.width,
        header.height);
  ImageFileInfo info;
  info.width = int(header.width);
  info.height = int(header.height);
  info.channels = 3;
  info.bitsPerChannel = int(std::min<std::uint32_t>(header.bitsPerChannel, 64));
  info.orientation = header.orientation >= 1 && header.orientation <= 8 ? int(header.orientation) : 1;
  info.capture = {
      positive(header.exposureTime),  positive(header.fNumber), positive(header.iso), positive(header.focalLength),
      positive(header.focalLength35), textOf(header.maker),     textOf(header.model), textOf(header.lens)};
  info.format = format;
  return info;
}

std::optional<ImageFormat> programFormat(Bytes file) {
  const std::string_view begin(reinterpret_cast<const char*>(file.data()), std::min<std::size_t>(file.size(), 16));
  const auto at = [&](std::size_t offset, std::string_view magic) {
    return begin.size() >= offset + magic.size() && begin.substr(offset, magic.size()) == magic;
  };
  using namespace std::string_view_literals;
  if (at(4, "ftypavif") || at(4, "ftypavis")) return ImageFormat::avif;
  if (at(4, "ftyphei") || at(4, "ftyphev") || at(4, "ftypmif1") || at(4, "ftypmsf1")) return ImageFormat::heic;
  if (at(0, "RIFF") && at(8, "WEBP")) return ImageFormat::webp;
  // Canon CR3 and CRW; Fujifilm; Panasonic; Olympus; Sigma; Minolta.
  if (at(4, "ftypcrx ") || at(6, "HEAPCCDR") || at(0, "FUJIFILM") || at(0, "IIU\0"sv) || at(0, "IIRO") ||
      at(0, "IIRS") || at(0, "MMOR") || at(0, "FOVb") || at(0, "\0MRM"sv) || isRawTiff(file))
    return ImageFormat::raw;
  return std::nullopt;
}

const char* formatName(ImageFormat format) {
  constexpr const char* kNames[] = {"JPEG", "PNG", "TIFF", "HEIC", "AVIF", "WebP", "raw"};
  return kNames[std::size_t(format)];
}

ImageFileInfo probeByProgram(Bytes file, const std::string& name) {
  return decode(file, name, {}, nullptr);
}

Image8 readByProgram(Bytes file, const std::string& name, const ReadLimits& limits, ImageFileInfo& info) {
  Image8 picture;
  info = decode(file, name, limits, &picture.values);
  picture.width = info.width;
  picture.height = info.height;
  picture.channels = 3;
  return picture;
}

}  // namespace ibr::io
