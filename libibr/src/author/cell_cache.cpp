// SPDX-License-Identifier: Apache-2.0
#include "author/cell_cache.h"

#include <cstring>
#include <type_traits>
#include <vector>

#include "author/kept_file.h"
#include "base/check.h"

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
  std::vector<std::byte> take() { return std::move(out_); }

 private:
  std::vector<std::byte> out_;
};

class Reader {
 public:
  explicit Reader(std::vector<std::byte> bytes) : bytes_(std::move(bytes)) {}

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

constexpr const char* kKind = "cell";  // of kept file

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
  storeKept(keptFile(folder, key, kKind), out.take());
}

std::optional<CellMesh> fetchCell(const std::filesystem::path& folder, std::uint64_t key) {
  auto bytes = fetchKept(keptFile(folder, key, kKind));
  if (!bytes) return std::nullopt;
  Reader in(std::move(*bytes));
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
