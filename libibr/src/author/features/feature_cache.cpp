// SPDX-License-Identifier: Apache-2.0
// File format: two counts, then the arrays.
#include "author/features/feature_cache.h"

#include <cstring>
#include <span>

#include "author/jobs/cached_file.h"

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
  storeCached(file, std::move(bytes));
}

std::optional<Features> fetchFeatures(const fs::path& file) {
  const auto bytes = fetchCached(file);  // complete: the counts can be trusted
  std::uint64_t counts[2];
  if (!bytes || bytes->size() < sizeof(counts)) return std::nullopt;
  std::memcpy(counts, bytes->data(), sizeof(counts));
  Features features;
  features.at.resize(counts[0]);
  features.first.resize(counts[0] + 1);
  features.descriptor.resize(counts[1]);
  std::size_t at = sizeof(counts);
  const auto take = [&]<class T>(std::vector<T>& values) {
    if (!values.empty()) std::memcpy(values.data(), bytes->data() + at, values.size() * sizeof(T));
    at += values.size() * sizeof(T);
  };
  take(features.at);
  take(features.first);
  take(features.descriptor);
  return features;
}

}  // namespace ibr
