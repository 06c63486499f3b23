// SPDX-License-Identifier: Apache-2.0
// Serialises numbers and lists of numbers for cached files (cached_file.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/check.h"
#include "ibr/scene.h"

namespace ibr {

class CacheWriter {
 public:
  template <class T>
  void value(const T& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto bytes = std::as_bytes(std::span(&v, 1));
    out_.insert(out_.end(), bytes.begin(), bytes.end());
  }
  template <class T>
  void list(const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    value(std::uint64_t(values.size()));
    const auto bytes = std::as_bytes(std::span(values));
    out_.insert(out_.end(), bytes.begin(), bytes.end());
  }
  void text(std::string_view text) {
    value(std::uint64_t(text.size()));
    const auto bytes = std::as_bytes(std::span(text));
    out_.insert(out_.end(), bytes.begin(), bytes.end());
  }
  /// Leaves out confirmations and consensus, which depend on all photographs of a scene.
  void mesh(const MorphMesh& mesh);
  std::vector<std::byte> take() { return std::move(out_); }

 private:
  std::vector<std::byte> out_;
};

/// Reads what a CacheWriter wrote, in the same order. Throws Error{invalidInput} if the data end too early.
class CacheReader {
 public:
  explicit CacheReader(std::vector<std::byte> bytes) : bytes_(std::move(bytes)) {}

  template <class T>
  T value() {
    T v;
    take(&v, sizeof(T));
    return v;
  }
  template <class T>
  std::vector<T> list() {
    const auto count = value<std::uint64_t>();
    check(count <= (bytes_.size() - at_) / sizeof(T), ErrorCode::invalidInput, "a cached file is truncated");
    std::vector<T> values(count);
    take(values.data(), values.size() * sizeof(T));
    return values;
  }
  std::string text() {
    const auto size = value<std::uint64_t>();
    check(size <= bytes_.size() - at_, ErrorCode::invalidInput, "a cached file is truncated");
    std::string text(size, '\0');
    take(text.data(), size);
    return text;
  }
  MorphMesh mesh();

 private:
  void take(void* to, std::size_t size) {
    check(size <= bytes_.size() - at_, ErrorCode::invalidInput, "a cached file is truncated");
    if (size > 0) std::memcpy(to, bytes_.data() + at_, size);
    at_ += size;
  }
  std::vector<std::byte> bytes_;
  std::size_t at_ = 0;
};

inline void CacheWriter::mesh(const MorphMesh& mesh) {
  value(std::uint64_t(mesh.memberCount()));
  for (const auto& match : mesh.match) list(match);
  for (const auto& ratio : mesh.ratio) list(ratio);
  list(mesh.inverseDistance);
  list(mesh.uncertainty);
  list(mesh.triangles);
  list(mesh.tier);
  list(mesh.ecc);
  list(mesh.planes);
}

inline MorphMesh CacheReader::mesh() {
  MorphMesh mesh;
  mesh.match.resize(value<std::uint64_t>());
  mesh.ratio.resize(mesh.match.size());
  for (auto& match : mesh.match) match = list<glm::vec2>();
  for (auto& ratio : mesh.ratio) ratio = list<float>();
  mesh.inverseDistance = list<float>();
  mesh.uncertainty = list<float>();
  mesh.triangles = list<glm::uvec3>();
  mesh.tier = list<std::uint8_t>();
  mesh.ecc = list<float>();
  mesh.planes = list<glm::u16vec4>();
  return mesh;
}

}  // namespace ibr
