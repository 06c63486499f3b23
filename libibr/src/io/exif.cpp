// SPDX-License-Identifier: Apache-2.0
// EXIF 2.32 §4.5–4.6: a TIFF header, and a first directory (IFD0) of 12-byte entries.
#include "io/exif.h"

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

}  // namespace

int exifOrientation(std::span<const std::byte> tiff) {
  constexpr std::uint32_t kOrientation = 0x0112, kShort = 3;
  if (tiff.size() < 8 || tiff[0] != tiff[1] || (tiff[0] != std::byte('I') && tiff[0] != std::byte('M'))) return 1;
  const Fields fields(tiff, tiff[0] == std::byte('M'));
  if (fields.read(2, 2) != 42u) return 1;
  const std::size_t directory = *fields.read(4, 4);
  const std::uint32_t entries = fields.read(directory, 2).value_or(0);
  for (std::uint32_t i = 0; i < entries; ++i) {
    const std::size_t entry = directory + 2 + 12 * std::size_t(i);
    const auto tag = fields.read(entry, 2);
    if (!tag) return 1;
    if (*tag != kOrientation) continue;
    const auto value = fields.read(entry + 8, 2);
    const bool valid = fields.read(entry + 2, 2) == kShort && value && *value >= 1 && *value <= 8;
    return valid ? int(*value) : 1;
  }
  return 1;
}

}  // namespace ibr::io
