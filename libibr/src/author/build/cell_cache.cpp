// SPDX-License-Identifier: Apache-2.0
#include "author/build/cell_cache.h"

#include "author/jobs/cached_file.h"
#include "author/jobs/cached_values.h"

namespace ibr {
namespace {

constexpr const char* kKind = "cell";  // of cache files

}  // namespace

std::filesystem::path cellFile(const std::filesystem::path& folder, std::uint64_t key) {
  return cacheFile(folder, key, kKind);
}

void storeCell(const std::filesystem::path& folder, std::uint64_t key, const CellMesh& cell) {
  CacheWriter out;
  out.mesh(cell.mesh);
  out.value(cell.quality.coverage);
  out.value(cell.quality.ecc);
  out.value(cell.quality.residualPx);
  storeCached(cellFile(folder, key), out.take());
}

std::optional<CellMesh> fetchCell(const std::filesystem::path& folder, std::uint64_t key) {
  auto bytes = fetchCached(cellFile(folder, key));
  if (!bytes) return std::nullopt;
  CacheReader in(std::move(*bytes));
  CellMesh cell;
  cell.mesh = in.mesh();
  cell.quality.coverage = in.value<double>();
  cell.quality.ecc = in.value<double>();
  cell.quality.residualPx = in.value<double>();
  return cell;
}

}  // namespace ibr
