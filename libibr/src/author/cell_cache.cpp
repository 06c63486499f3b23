// SPDX-License-Identifier: Apache-2.0
// The file is private to a build on one machine: numbers as they lie in memory, and a hash of them at the end.
#include "author/cell_cache.h"

#include <cstring>
#include <type_traits>
#include <vector>

#include "author/hash.h"
#include "base/check.h"
#include "base/file.h"

namespace ibr {
namespace {

class Writer {
 public:
  template <class T>
  void value(const T& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto* const bytes = reinterpret_cast<const std::byte*>(&v);
    out_.insert(out_.end(), bytes, bytes + sizeof(T));
  }
  template <class T>
  void list(const std::vector<T>& values) {
    value(std::uint64_t(values.size()));
    const auto bytes = std::as_bytes(std::span(values));
    out_.insert(out_.end(), bytes.begin(), bytes.end());
  }
  std::vector<std::byte> take() {
    Hash hash;
    hash.add(out_);
    value(hash.value());
    return std::move(out_);
  }

 private:
  std::vector<std::byte> out_;
};

class Reader {
 public:
  explicit Reader(std::vector<std::byte> bytes) : bytes_(std::move(bytes)) {}

  /// Whether the hash at the end fits; it is no longer part of the contents then.
  bool whole() {
    if (bytes_.size() < sizeof(std::uint64_t)) return false;
    std::uint64_t stored;
    std::memcpy(&stored, bytes_.data() + bytes_.size() - sizeof(stored), sizeof(stored));
    bytes_.resize(bytes_.size() - sizeof(stored));
    Hash hash;
    hash.add(bytes_);
    return hash.value() == stored;
  }
  template <class T>
  T value() {
    T v;
    take(&v, sizeof(T));
    return v;
  }
  template <class T>
  std::vector<T> list() {
    std::vector<T> values(value<std::uint64_t>());
    take(values.data(), values.size() * sizeof(T));
    return values;
  }

 private:
  void take(void* to, std::size_t size) {
    check(size <= bytes_.size() - at_, ErrorCode::invalidInput, "a kept cell ends too early");
    if (size > 0) std::memcpy(to, bytes_.data() + at_, size);
    at_ += size;
  }
  std::vector<std::byte> bytes_;
  std::size_t at_ = 0;
};

std::filesystem::path fileOf(const std::filesystem::path& folder, std::uint64_t key) {
  return folder / fmt::format("{:016x}.cell", key);
}

}  // namespace

void storeCell(const std::filesystem::path& folder, std::uint64_t key, const CellMesh& cell) {
  Writer out;
  const MorphMesh& mesh = cell.mesh;
  out.value(std::uint64_t(mesh.memberCount()));
  for (const auto& match : mesh.match) out.list(match);
  for (const auto& ratio : mesh.ratio) out.list(ratio);
  out.list(mesh.inverseDistance);
  out.list(mesh.uncertainty);
  out.list(mesh.triangles);
  out.list(mesh.tier);
  out.list(mesh.ecc);
  out.list(mesh.planes);
  out.value(cell.quality.coverage);
  out.value(cell.quality.ecc);
  out.value(cell.quality.residualPx);
  writeFile(fileOf(folder, key), out.take());
}

std::optional<CellMesh> fetchCell(const std::filesystem::path& folder, std::uint64_t key) {
  if (!std::filesystem::exists(fileOf(folder, key))) return std::nullopt;
  Reader in(readFile(fileOf(folder, key)));
  if (!in.whole()) return std::nullopt;
  CellMesh cell;
  MorphMesh& mesh = cell.mesh;
  mesh.match.resize(in.value<std::uint64_t>());
  mesh.ratio.resize(mesh.match.size());
  for (auto& match : mesh.match) match = in.list<glm::vec2>();
  for (auto& ratio : mesh.ratio) ratio = in.list<float>();
  mesh.inverseDistance = in.list<float>();
  mesh.uncertainty = in.list<float>();
  mesh.triangles = in.list<glm::uvec3>();
  mesh.tier = in.list<std::uint8_t>();
  mesh.ecc = in.list<float>();
  mesh.planes = in.list<glm::u16vec4>();
  cell.quality.coverage = in.value<double>();
  cell.quality.ecc = in.value<double>();
  cell.quality.residualPx = in.value<double>();
  return cell;
}

}  // namespace ibr
