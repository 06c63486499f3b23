// SPDX-License-Identifier: Apache-2.0
#include "io/image_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <optional>
#include <string_view>
#include <utility>

#include "base/check.h"
#include "base/file.h"
#include "io/codec.h"
#include "io/decoded.h"
#include "io/exif.h"

namespace fs = std::filesystem;

namespace ibr {
namespace io {

void checkSize(const ImageFileInfo& info, const ReadLimits& limits, const std::string& name) {
  const bool fits = info.width > 0 && info.height > 0 && info.width <= limits.side && info.height <= limits.side &&
                    std::int64_t(info.width) * info.height <= limits.pixels;
  check(fits, ErrorCode::invalidInput, "{}: {}×{} pixels; the limits are {} per side and {} in total", name, info.width,
        info.height, limits.side, limits.pixels);
}

namespace {

struct Format {
  bool headFirst;  // the start of the file is enough for most probes
  ImageFileInfo (*probe)(Bytes, const std::string&);
  Image8 (*read)(Bytes, const std::string&, const ReadLimits&, ImageFileInfo&);
};

constexpr std::size_t kMagicBytes = 16;

// Detects the format by content; file names can be wrong.
std::optional<Format> formatThatBegins(Bytes file) {
  const auto startsWith = [&](auto... bytes) {
    const std::array magic{std::byte(bytes)...};
    return file.size() >= magic.size() && std::equal(magic.begin(), magic.end(), file.begin());
  };
  if (startsWith(0xff, 0xd8, 0xff)) return Format{true, probeJpeg, readJpeg};
  if (startsWith(0x89, 'P', 'N', 'G', 0x0d, 0x0a, 0x1a, 0x0a)) return Format{true, probePng, readPng};
  if (programFormat(file)) return Format{false, probeByProgram, readByProgram};
  if (startsWith('I', 'I', 42, 0) || startsWith('M', 'M', 0, 42) || startsWith('I', 'I', 43, 0) ||
      startsWith('M', 'M', 0, 43))
    return Format{true, probeTiff, readTiff};
  return std::nullopt;
}

// Detects other formats by their first bytes: returns the format's name, or "".
const char* unsupportedFormat(Bytes file) {
  if (programFormat(file)) return "";
  const std::string_view begin(reinterpret_cast<const char*>(file.data()), std::min(file.size(), kMagicBytes));
  const auto at = [&](std::size_t offset, std::string_view magic) {
    return begin.size() >= offset + magic.size() && begin.substr(offset, magic.size()) == magic;
  };
  using namespace std::string_view_literals;
  if (at(4, "ftyp")) return "video";
  if (at(0, "GIF8")) return "GIF";
  if (at(0, "BM")) return "BMP";
  if (at(0, "8BPS")) return "PSD";
  if (at(0, "\xff\x0a"sv) || at(0, "\0\0\0\x0cJXL "sv)) return "JPEG XL";
  if (at(0, "\0\0\0\x0cjP  "sv)) return "JPEG 2000";
  return "";
}

Format formatOf(Bytes file, const std::string& name) {
  const auto format = formatThatBegins(file);
  check(!file.empty(), ErrorCode::invalidInput, "{}: is empty", name);
  const char* const foreign = unsupportedFormat(file);
  check(format.has_value() || !*foreign, ErrorCode::unsupported,
        "{}: {} files are not supported; convert the file to JPEG", name, foreign);
  check(format.has_value(), ErrorCode::invalidInput, "{}: is none of JPEG, PNG, TIFF, HEIC, AVIF, WebP and raw", name);
  return *format;
}

std::string lowerExtension(const fs::path& path) {
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return char(std::tolower(c)); });
  return extension;
}

}  // namespace
}  // namespace io

ImageFileInfo probeImage(const fs::path& path) {
  constexpr std::size_t kPrefix = std::size_t(1) << 18;
  const std::string name = path.string();
  // Most headers are in the first few kilobytes; if not, the whole file is read.
  std::error_code ignored;
  if (fs::is_regular_file(path, ignored) && fs::file_size(path, ignored) > kPrefix) {
    std::vector<std::byte> prefix(kPrefix);
    std::ifstream file(path, std::ios::binary);
    file.read(reinterpret_cast<char*>(prefix.data()), std::streamsize(prefix.size()));
    if (file) {
      const auto format = io::formatOf(prefix, name);
      try {
        if (format.headFirst) return format.probe(prefix, name);
      } catch (const Error&) {
      }
    }
  }
  const auto file = readFile(path);
  return io::formatOf(file, name).probe(file, name);
}

// Applies the EXIF orientation (EXIF 2.32 §4.6.4.A: positions of row 0 and column 0).
Image8 upright(const Image8& stored, int orientation) {
  const bool swapped = orientation >= 5;
  const bool mirroredX = orientation == 2 || orientation == 3 || orientation == 7 || orientation == 8;
  const bool mirroredY = orientation == 3 || orientation == 4 || orientation == 6 || orientation == 7;
  Image8 image(swapped ? stored.height : stored.width, swapped ? stored.width : stored.height, stored.channels);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const int u = swapped ? y : x, v = swapped ? x : y;
      const auto from = stored.pixel(mirroredX ? stored.width - 1 - u : u, mirroredY ? stored.height - 1 - v : v);
      std::ranges::copy(from, image.pixel(x, y).begin());
    }
  return image;
}

Image8 readImage(const fs::path& path, bool applyOrientation, const ReadLimits& limits) {
  const std::string name = path.string();
  const auto file = readFile(path);
  ImageFileInfo info;
  Image8 image = io::formatOf(file, name).read(file, name, limits, info);
  return applyOrientation && info.orientation != 1 ? upright(image, info.orientation) : image;
}

Image<std::uint16_t> readGrey16(const fs::path& path, const ReadLimits& limits) {
  return io::readPngGrey16(readFile(path), path.string(), limits);
}

void writeImage(const fs::path& path, const Image8& image, int quality) {
  assert(image.width > 0 && image.height > 0 && quality >= 1 && quality <= 100);
  const std::string name = path.string();
  const std::string extension = io::lowerExtension(path);
  const bool jpeg = extension == ".jpg" || extension == ".jpeg";
  check(jpeg || extension == ".png", ErrorCode::unsupported, "{}: the file extension is not .png, .jpg or .jpeg", name);
  check(image.channels == 1 || image.channels == 3 || (image.channels == 4 && !jpeg), ErrorCode::unsupported,
        "{}: {} channels are not supported by the format", name, image.channels);
  writeFile(path, jpeg ? io::encodeJpeg(image, quality, name) : io::encodePng(image, {}, name));
}

void writePhotograph(const fs::path& path, const Image8& image, int quality, const CaptureMetadata& capture,
                     const std::optional<GeoLocation>& location) {
  writeFile(path, io::withExif(io::encodeJpeg(image, quality, path.string()), io::exifBlock(capture, location)));
}

void writeJpegCopy(const fs::path& from, const fs::path& to, bool applyOrientation) {
  constexpr int kQuality = 95;
  const std::string name = from.string();
  const auto file = readFile(from);
  const io::Format format = io::formatOf(file, name);
  ImageFileInfo info;
  Image8 image = format.read(file, name, {}, info);
  if (applyOrientation && info.orientation != 1) image = upright(image, info.orientation);
  std::vector<std::byte> exif = format.read == io::readJpeg ? io::exifOf(file, name) : io::exifBlock(info.capture);
  std::vector<std::byte> jpeg = io::encodeJpeg(image, kQuality, to.string());
  writeFile(to, exif.empty() ? std::move(jpeg) : io::withExif(std::move(jpeg), exif));
}

void writeImage(const fs::path& path, const Image8& image, const std::vector<ImageText>& texts) {
  assert(image.width > 0 && image.height > 0);
  const std::string name = path.string();
  check(io::lowerExtension(path) == ".png", ErrorCode::unsupported, "{}: only .png files can hold texts", name);
  check(image.channels == 1 || image.channels == 3 || image.channels == 4, ErrorCode::unsupported,
        "{}: {} channels are not supported by the format", name, image.channels);
  for (const auto& [key, text] : texts) {
    const auto printable = [](char c) { return c >= ' ' && c <= '~'; };
    check(!key.empty() && key.size() < 80 && std::ranges::all_of(key, printable) && key.front() != ' ' &&
              key.back() != ' ' && key.find("  ") == std::string::npos,
          ErrorCode::invalidInput, "{}: \"{}\" is not a valid key of a PNG text", name, key);
    check(text.find('\0') == std::string::npos, ErrorCode::invalidInput, "{}: the text \"{}\" has a zero byte", name,
          key);
  }
  writeFile(path, io::encodePng(image, texts, name));
}

std::vector<ImageText> readImageTexts(const fs::path& path) {
  const std::string name = path.string();
  const auto file = readFile(path);
  return io::formatOf(file, name).read == io::readPng ? io::pngTexts(file, name) : std::vector<ImageText>();
}

std::string unsupportedImageFormat(const fs::path& path) {
  return io::unsupportedFormat(readFileStart(path, io::kMagicBytes));
}

bool isImageFile(const fs::path& path) noexcept {
  try {
    return io::formatThatBegins(readFileStart(path, io::kMagicBytes)).has_value();
  } catch (...) {
    return false;
  }
}

}  // namespace ibr
