// SPDX-License-Identifier: Apache-2.0
#include "author/jobs/cached_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <span>
#include <string>

#include "base/file.h"
#include "base/hash.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kDigits = 16;  // hex digits of a key
using Value = std::uint64_t;         // of the hash

Value hashOf(std::span<const std::byte> bytes) {
  Hash hash;
  hash.add(bytes);
  return hash.value();
}

// True for names of cacheFile, and of drafts that writeFile did not finish.
bool isCacheFileName(const std::string& name) {
  return name.size() > kDigits && name[kDigits] == '.' && std::all_of(name.begin(), name.begin() + kDigits, [](char c) {
           return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
         });
}

// Uses this process's clock: the file system's clock may differ.
void markUsed(const fs::path& file) {
  std::error_code ignored;
  fs::last_write_time(file, fs::file_time_type::clock::now(), ignored);
}

}  // namespace

fs::path cacheFile(const fs::path& folder, std::uint64_t key, const char* kind) {
  return folder / fmt::format("{:0{}x}.{}", key, kDigits, kind);
}

void storeCached(const fs::path& file, std::vector<std::byte> bytes) {
  const Value value = hashOf(bytes);
  const auto end = std::as_bytes(std::span(&value, 1));
  bytes.insert(bytes.end(), end.begin(), end.end());
  writeFile(file, bytes);
  markUsed(file);
}

std::optional<std::vector<std::byte>> fetchCached(const fs::path& file) {
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return std::nullopt;
  std::vector<std::byte> bytes = readFile(file);
  Value stored;
  if (bytes.size() < sizeof(stored)) return std::nullopt;
  std::memcpy(&stored, bytes.data() + bytes.size() - sizeof(stored), sizeof(stored));
  bytes.resize(bytes.size() - sizeof(stored));
  if (hashOf(bytes) != stored) return std::nullopt;
  markUsed(file);
  return bytes;
}

void removeCached(const fs::path& folder) {
  removeCachedBefore(folder, fs::file_time_type::max());
}

void removeCachedBefore(const fs::path& folder, fs::file_time_type time) {
  std::error_code ignored;
  std::vector<fs::path> files;
  for (fs::directory_iterator entry(folder, ignored), end; entry != end; entry.increment(ignored))
    if (isCacheFileName(entry->path().filename().string()) && entry->last_write_time(ignored) < time)
      files.push_back(entry->path());
  for (const fs::path& file : files) fs::remove(file, ignored);
  fs::remove(folder, ignored);
}

}  // namespace ibr
