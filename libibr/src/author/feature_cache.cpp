// SPDX-License-Identifier: Apache-2.0
// Two counts, the numbers as they lie in memory, and their hash.
#include "author/feature_cache.h"

#include <cstring>
#include <span>

#include "author/hash.h"
#include "base/file.h"

namespace ibr {
namespace fs = std::filesystem;

void storeFeatures(const fs::path& file, const Features& features) {
  const std::uint64_t counts[] = {features.at.size(), features.descriptor.size()};
  std::vector<std::byte> bytes;
  const auto add = [&](std::span<const std::byte> part) { bytes.insert(bytes.end(), part.begin(), part.end()); };
  add(std::as_bytes(std::span(counts)));
  add(std::as_bytes(std::span(features.at)));
  add(std::as_bytes(std::span(features.first)));
  add(std::as_bytes(std::span(features.descriptor)));
  Hash hash;
  hash.add(bytes);
  const std::uint64_t value = hash.value();
  add(std::as_bytes(std::span(&value, 1)));
  writeFile(file, bytes);
}

std::optional<Features> fetchFeatures(const fs::path& file) {
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return std::nullopt;
  const std::vector<std::byte> bytes = readFile(file);
  std::uint64_t counts[2], stored;
  if (bytes.size() < sizeof(counts) + sizeof(stored)) return std::nullopt;
  std::memcpy(&stored, bytes.data() + bytes.size() - sizeof(stored), sizeof(stored));
  Hash hash;
  hash.add(std::span(bytes).first(bytes.size() - sizeof(stored)));
  if (hash.value() != stored) return std::nullopt;  // so that the counts can be trusted
  std::memcpy(counts, bytes.data(), sizeof(counts));
  Features features;
  features.at.resize(counts[0]);
  features.first.resize(counts[0] + 1);
  features.descriptor.resize(counts[1]);
  std::size_t at = sizeof(counts);
  const auto take = [&]<class T>(std::vector<T>& values) {
    if (!values.empty()) std::memcpy(values.data(), bytes.data() + at, values.size() * sizeof(T));
    at += values.size() * sizeof(T);
  };
  take(features.at);
  take(features.first);
  take(features.descriptor);
  return features;
}

}  // namespace ibr
