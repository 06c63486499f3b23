// SPDX-License-Identifier: Apache-2.0
//   key                    8 bytes
//   number of parts        8 bytes
//   end of each part       8 bytes each, from the start of the file
//   parts                  each followed by its hash, 8 bytes
#include "author/steps/parts_file.h"

#include <algorithm>
#include <array>
#include <utility>

#include "base/check.h"
#include "base/hash.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

using Number = std::uint64_t;
constexpr std::size_t kHeaderBytes = 2 * sizeof(Number);

Number hashOf(std::span<const std::byte> bytes) {
  Hash hash;
  hash.add(bytes);
  return hash.value();
}

InputFile opened(const fs::path& file, const char* step) {
  std::error_code ignored;
  check(fs::is_regular_file(file, ignored), ErrorCode::io, "{}: is missing; run the step {} first", file.string(),
        step);
  return InputFile(file);
}

}  // namespace

void writeParts(const fs::path& file, std::uint64_t key, std::span<const std::vector<std::byte>> parts) {
  CacheWriter out;
  out.value(key);
  out.value(Number(parts.size()));
  Number end = kHeaderBytes + parts.size() * sizeof(Number);
  for (const std::vector<std::byte>& part : parts) out.value(end += part.size() + sizeof(Number));
  std::vector<std::byte> bytes = out.take();
  for (const std::vector<std::byte>& part : parts) {
    const Number hash = hashOf(part);
    const auto tail = std::as_bytes(std::span(&hash, 1));
    bytes.insert(bytes.end(), part.begin(), part.end());
    bytes.insert(bytes.end(), tail.begin(), tail.end());
  }
  writeFile(file, bytes);
}

PartsFile::PartsFile(const fs::path& file, std::uint64_t key, const char* step)
    : path_(file), step_(step), file_(opened(file, step)) {
  std::array<Number, 2> header{};
  check(file_.size() >= kHeaderBytes, ErrorCode::io, "{}: is damaged; delete it, and run the step {} again",
        path_.string(), step_);
  file_.read(0, std::as_writable_bytes(std::span(header)));
  check(header[0] == key, ErrorCode::invalidInput,
        "{}: was made with other options: give all steps the same options, or run the step {} again", path_.string(),
        step_);
  check(header[1] <= (file_.size() - kHeaderBytes) / sizeof(Number), ErrorCode::io,
        "{}: is damaged; delete it, and run the step {} again", path_.string(), step_);
  ends_.resize(header[1]);
  file_.read(kHeaderBytes, std::as_writable_bytes(std::span(ends_)));
}

CacheReader PartsFile::part(std::size_t index) const {
  check(index < ends_.size(), ErrorCode::invalidInput, "{}: has {} parts, not {}", path_.string(), ends_.size(),
        index + 1);
  const Number begin = index == 0 ? kHeaderBytes + ends_.size() * sizeof(Number) : ends_[index - 1];
  const Number end = ends_[index];
  const bool fits = begin + sizeof(Number) <= end && end <= file_.size();
  std::vector<std::byte> bytes(fits ? end - begin - sizeof(Number) : 0);
  Number stored = 0;
  if (fits) {
    file_.read(begin, bytes);
    file_.read(end - sizeof(Number), std::as_writable_bytes(std::span(&stored, 1)));
  }
  check(fits && hashOf(bytes) == stored, ErrorCode::io, "{}: is damaged; delete it, and run the step {} again",
        path_.string(), step_);
  return CacheReader(std::move(bytes));
}

}  // namespace ibr
