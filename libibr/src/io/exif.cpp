// SPDX-License-Identifier: Apache-2.0
// EXIF 2.32 §4.5–4.6: a TIFF header, a directory (IFD0) of 12-byte entries, and a second one (Exif IFD) it points to.
#include "io/exif.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

namespace ibr::io {
namespace {

class Fields {
 public:
  Fields(std::span<const std::byte> bytes, bool bigEndian) : bytes_(bytes), bigEndian_(bigEndian) {}

  std::optional<std::uint32_t> read(std::size_t at, std::size_t size) const {
    if (at > bytes_.size() || bytes_.size() - at < size) return std::nullopt;
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < size; ++i)
      value = value << 8 | std::to_integer<std::uint32_t>(bytes_[at + (bigEndian_ ? i : size - 1 - i)]);
    return value;
  }

 private:
  std::span<const std::byte> bytes_;
  bool bigEndian_;
};

enum Type : std::uint32_t { kByte = 1, kAscii = 2, kShort = 3, kLong = 4, kRational = 5 };

// One directory of EXIF entries.
class Directory {
 public:
  Directory(const Fields& fields, std::size_t at)
      : fields_(fields), at_(at), entries_(fields.read(at, 2).value_or(0)) {}

  // First value of an integer entry; nullopt for other types.
  std::optional<std::uint32_t> integer(std::uint32_t tag) const {
    const auto entry = find(tag);
    const auto type = entry ? fields_.read(*entry + 2, 2) : std::nullopt;
    if (type == kShort) return fields_.read(*entry + 8, 2);
    return type == kLong ? fields_.read(*entry + 8, 4) : std::nullopt;
  }

  bool has(std::uint32_t tag) const { return find(tag).has_value(); }

  std::vector<std::uint16_t> numbers() const {
    std::vector<std::uint16_t> all;
    for (std::uint32_t i = 0; i < entries_; ++i) {
      const auto number = fields_.read(at_ + 2 + 12 * std::size_t(i), 2);
      if (!number) break;
      all.push_back(std::uint16_t(*number));
    }
    return all;
  }
  // Offset of the next directory.
  std::optional<std::uint32_t> next() const { return fields_.read(at_ + 2 + 12 * std::size_t(entries_), 4); }

  std::uint32_t byte(std::uint32_t tag) const {
    const auto entry = find(tag);
    return entry ? fields_.read(*entry + 8, 1).value_or(0) : 0;
  }

  // A value of a rational entry; 0 if it is not a positive number.
  double ratio(std::uint32_t tag, std::uint32_t index = 0) const {
    const auto entry = find(tag);
    if (!entry || fields_.read(*entry + 2, 2) != kRational || index >= fields_.read(*entry + 4, 4).value_or(0))
      return 0;
    const std::size_t at = std::size_t(fields_.read(*entry + 8, 4).value_or(~0u)) + 8 * std::size_t(index);
    const double above = fields_.read(at, 4).value_or(0), below = fields_.read(at + 4, 4).value_or(0);
    return below > 0 ? above / below : 0;
  }

  // Offset and size, in bytes, of the value that integer() reads.
  struct ValueLocation {
    std::size_t at, bytes;
  };
  std::optional<ValueLocation> integerLocation(std::uint32_t tag) const {
    if (!integer(tag)) return std::nullopt;
    const std::size_t entry = *find(tag);
    return ValueLocation{entry + 8, fields_.read(entry + 2, 2) == kShort ? std::size_t(2) : std::size_t(4)};
  }

  std::string text(std::uint32_t tag) const {
    constexpr std::uint32_t kLongest = 128;
    const auto entry = find(tag);
    if (!entry || fields_.read(*entry + 2, 2) != kAscii) return {};
    const std::uint32_t count = fields_.read(*entry + 4, 4).value_or(0);
    const std::size_t at = count <= 4 ? *entry + 8 : fields_.read(*entry + 8, 4).value_or(~0u);
    std::string text;
    for (std::uint32_t i = 0; i < std::min(count, kLongest); ++i) {
      const std::uint32_t c = fields_.read(at + i, 1).value_or(0);
      if (c == 0) break;
      text += c >= ' ' && c <= '~' ? char(c) : '?';
    }
    text.erase(text.find_last_not_of(' ') + 1);
    return text;
  }

 private:
  std::optional<std::size_t> find(std::uint32_t tag) const {
    for (std::uint32_t i = 0; i < entries_; ++i) {
      const std::size_t entry = at_ + 2 + 12 * std::size_t(i);
      const auto found = fields_.read(entry, 2);
      if (!found) return std::nullopt;
      if (*found == tag) return entry;
    }
    return std::nullopt;
  }

  const Fields& fields_;
  std::size_t at_;
  std::uint32_t entries_;
};

// A 16-bit value of 65535 refers to the wider tags (§4.6.5, PhotographicSensitivity).
double sensitivity(const Directory& exif) {
  constexpr std::uint32_t kPhotographic = 0x8827, kSeeThere = 65535;
  constexpr std::uint32_t kWide[] = {0x8832, 0x8833, 0x8831};  // recommended exposure index, ISO speed, standard output
  const std::uint32_t stated = exif.integer(kPhotographic).value_or(0);
  if (stated != kSeeThere) return stated;
  for (const std::uint32_t tag : kWide)
    if (const auto value = exif.integer(tag); value.value_or(0) > 0) return *value;
  return 0;
}

constexpr std::uint32_t kOrientation = 0x0112, kExif = 0x8769, kGps = 0x8825;

// EXIF 2.32 §4.6.6: degrees, minutes and seconds. nullopt unless both angles are stated.
std::optional<GeoLocation> locationOf(const Directory& gps) {
  const auto angle = [&](std::uint32_t tag, const char* negative) {
    return (gps.text(tag) == negative ? -1 : 1) *
           (gps.ratio(tag + 1) + gps.ratio(tag + 1, 1) / 60 + gps.ratio(tag + 1, 2) / 3600);
  };
  const GeoLocation location{angle(1, "S"), angle(3, "W"), std::nullopt};
  const bool stated =
      gps.has(2) && gps.has(4) && std::abs(location.latitude) <= 90 && std::abs(location.longitude) <= 180;
  if (!stated) return std::nullopt;
  if (!gps.has(6)) return location;
  return GeoLocation{location.latitude, location.longitude, (gps.byte(5) == 1 ? -1 : 1) * gps.ratio(6)};
}

// Returns nullopt if there is no TIFF header.
std::optional<Fields> fieldsOf(std::span<const std::byte> tiff) {
  if (tiff.size() < 8 || tiff[0] != tiff[1] || (tiff[0] != std::byte('I') && tiff[0] != std::byte('M')))
    return std::nullopt;
  const Fields fields(tiff, tiff[0] == std::byte('M'));
  return fields.read(2, 2) == 42u ? std::optional(fields) : std::nullopt;
}

}  // namespace

std::vector<ExifTag> exifTags(std::span<const std::byte> tiff) {
  std::vector<ExifTag> tags;
  const auto fields = fieldsOf(tiff);
  if (!fields) return tags;
  const auto add = [&](const Directory& directory, bool preview) {
    for (const std::uint16_t number : directory.numbers()) tags.push_back({number, preview});
  };
  const Directory first(*fields, *fields->read(4, 4));
  add(first, false);
  if (const auto at = first.integer(kExif)) add(Directory(*fields, *at), false);
  if (const auto at = first.next(); at.value_or(0) > 0) add(Directory(*fields, *at), true);
  return tags;
}

bool isRawTiff(std::span<const std::byte> file) {
  const auto fields = fieldsOf(file);
  if (!fields) return false;
  constexpr std::uint32_t kCanon = 0x43520200;  // "CR", version 2
  if (Fields(file, true).read(8, 4) == kCanon) return true;
  // TIFF 6.0 §8, TIFF/EP §5.1, DNG 1.4 chapter 4; compressions of Sony, Samsung, Nikon, Pentax.
  constexpr std::uint32_t kSubfile = 0x00fe, kCompression = 0x0103, kPhotometric = 0x0106, kDngVersion = 0xc612;
  constexpr std::uint32_t kReduced = 1, kColourFilterArray = 32803, kLinearRaw = 34892;
  constexpr std::uint32_t kMakers[] = {32767, 32769, 32770, 34713, 65535};
  const Directory first(*fields, *fields->read(4, 4));
  const std::uint32_t photometric = first.integer(kPhotometric).value_or(0);
  return first.has(kDngVersion) || first.integer(kSubfile) == kReduced || photometric == kColourFilterArray ||
         photometric == kLinearRaw || std::ranges::find(kMakers, first.integer(kCompression)) != std::end(kMakers);
}

void resetOrientation(std::span<std::byte> tiff) {
  const auto fields = fieldsOf(tiff);
  if (!fields) return;
  const auto place = Directory(*fields, *fields->read(4, 4)).integerLocation(kOrientation);
  if (!place) return;
  const std::span<std::byte> value = tiff.subspan(place->at, place->bytes);
  std::ranges::fill(value, std::byte(0));
  (tiff[0] == std::byte('M') ? value.back() : value.front()) = std::byte(1);
}

Exif readExif(std::span<const std::byte> tiff) {
  Exif result;
  const auto header = fieldsOf(tiff);
  if (!header) return result;
  const Fields& fields = *header;
  const Directory first(fields, *fields.read(4, 4));
  if (const std::uint32_t value = first.integer(kOrientation).value_or(1); value >= 1 && value <= 8)
    result.orientation = int(value);
  CaptureMetadata& capture = result.capture;
  capture.maker = first.text(0x010f);
  capture.model = first.text(0x0110);
  if (const auto gps = first.integer(kGps)) result.location = locationOf(Directory(fields, *gps));
  const auto at = first.integer(kExif);
  if (!at) return result;
  const Directory exif(fields, *at);
  capture.exposureTime = exif.ratio(0x829a);
  capture.fNumber = exif.ratio(0x829d);
  capture.iso = sensitivity(exif);
  capture.focalLength = exif.ratio(0x920a);
  capture.focalLength35 = exif.integer(0xa405).value_or(0);
  capture.lens = exif.text(0xa434);
  if (const auto interoperability = exif.integer(0xa005))
    result.adobeRgb = Directory(fields, *interoperability).text(1) == "R03";
  return result;
}

namespace {

// Writes a little-endian TIFF block, directory by directory.
class BlockWriter {
 public:
  // Entries of one directory, by ascending tag.
  void shortValue(std::uint16_t tag, double value) {
    if (value >= 1 && value < 65535.5) add(tag, kShort, 1, std::uint32_t(std::lround(value)));
  }
  void longValue(std::uint16_t tag, std::uint32_t value) { add(tag, kLong, 1, value); }
  void text(std::uint16_t tag, const std::string& text) {
    if (text.empty()) return;
    std::vector<std::uint8_t> bytes(text.begin(), text.end());
    bytes.push_back(0);
    const auto count = std::uint32_t(bytes.size());
    if (count > 4) return addData(tag, kAscii, count, bytes);
    bytes.resize(4, 0);
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value |= std::uint32_t(bytes[i]) << (8 * i);
    add(tag, kAscii, count, value);
  }
  void ratio(std::uint16_t tag, double value) {
    if (!(value > 0) || value > 1e6) return;
    ratios(tag, {value}, value < 1 ? 1e6 : 1e3);
  }
  // Values of 0 or more, as fractions of this denominator.
  void ratios(std::uint16_t tag, std::initializer_list<double> values, double below) {
    std::vector<std::uint8_t> bytes;
    for (const double value : values) {
      put(bytes, std::uint32_t(std::lround(value * below)), 4);
      put(bytes, std::uint32_t(below), 4);
    }
    addData(tag, kRational, std::uint32_t(values.size()), bytes);
  }
  void byteValue(std::uint16_t tag, std::uint8_t value) { add(tag, kByte, 1, value); }

  // The directory for the offset `at` from the block's start; the next one begins at its end.
  std::vector<std::uint8_t> directory(std::uint32_t at) const {
    std::vector<std::uint8_t> bytes;
    put(bytes, std::uint32_t(entries_.size()), 2);
    for (const Entry& entry : entries_) {
      put(bytes, entry.tag, 2);
      put(bytes, entry.type, 2);
      put(bytes, entry.count, 4);
      put(bytes, entry.inData ? at + size() + entry.value : entry.value, 4);
    }
    put(bytes, 0, 4);  // no further directory
    bytes.insert(bytes.end(), data_.begin(), data_.end());
    return bytes;
  }
  std::uint32_t size() const { return std::uint32_t(6 + 12 * entries_.size()); }

 private:
  struct Entry {
    std::uint16_t tag;
    std::uint32_t type, count, value;
    bool inData;
  };
  static void put(std::vector<std::uint8_t>& bytes, std::uint32_t value, int size) {
    for (int i = 0; i < size; ++i) bytes.push_back(std::uint8_t(value >> (8 * i)));
  }
  void add(std::uint16_t tag, std::uint32_t type, std::uint32_t count, std::uint32_t value) {
    entries_.push_back({tag, type, count, value, false});
  }
  void addData(std::uint16_t tag, std::uint32_t type, std::uint32_t count, const std::vector<std::uint8_t>& bytes) {
    entries_.push_back({tag, type, count, std::uint32_t(data_.size()), true});
    data_.insert(data_.end(), bytes.begin(), bytes.end());
    if (data_.size() % 2) data_.push_back(0);
  }

  std::vector<Entry> entries_;
  std::vector<std::uint8_t> data_;
};

}  // namespace

std::vector<std::byte> exifBlock(const CaptureMetadata& capture, const std::optional<GeoLocation>& location) {
  BlockWriter exif;
  exif.ratio(0x829a, capture.exposureTime);
  exif.ratio(0x829d, capture.fNumber);
  exif.shortValue(0x8827, capture.iso);
  exif.ratio(0x920a, capture.focalLength);
  exif.shortValue(0xa405, capture.focalLength35);
  exif.text(0xa434, capture.lens);
  BlockWriter gps;
  if (location) {
    constexpr double kSecond = 1.0 / 3600, kParts = 1e4;
    const auto angle = [&](std::uint16_t tag, double degrees, const char* positive, const char* negative) {
      const double whole = std::floor(std::abs(degrees)), rest = (std::abs(degrees) - whole) / kSecond;
      gps.text(tag, degrees < 0 ? negative : positive);
      gps.ratios(std::uint16_t(tag + 1), {whole, std::floor(rest / 60), std::fmod(rest, 60)}, kParts);
    };
    angle(1, location->latitude, "N", "S");
    angle(3, location->longitude, "E", "W");
    if (location->altitude) {
      gps.byteValue(5, *location->altitude < 0);
      gps.ratios(6, {std::abs(*location->altitude)}, 1e3);
    }
  }
  // The first directory refers to the others by their offsets, which depend on its size.
  constexpr std::uint32_t kHeader = 8;
  const auto firstDirectory = [&](std::uint32_t exifAt, std::uint32_t gpsAt) {
    BlockWriter first;
    first.text(0x010f, capture.maker);
    first.text(0x0110, capture.model);
    first.shortValue(kOrientation, 1);
    first.longValue(kExif, exifAt);
    if (location) first.longValue(kGps, gpsAt);
    return first.directory(kHeader);
  };
  const std::uint32_t exifAt = kHeader + std::uint32_t(firstDirectory(0, 0).size());
  const std::vector<std::uint8_t> exifBytes = exif.directory(exifAt);
  const std::uint32_t gpsAt = exifAt + std::uint32_t(exifBytes.size());
  std::vector<std::uint8_t> bytes{'I', 'I', 42, 0, kHeader, 0, 0, 0};
  for (const std::vector<std::uint8_t>& more : {firstDirectory(exifAt, gpsAt), exifBytes, gps.directory(gpsAt)})
    bytes.insert(bytes.end(), more.begin(), more.end());
  std::vector<std::byte> block(bytes.size());
  std::ranges::transform(bytes, block.begin(), [](std::uint8_t v) { return std::byte(v); });
  return block;
}

}  // namespace ibr::io
