// SPDX-License-Identifier: Apache-2.0
#include "author/align/aligned_cache.h"

#include "author/jobs/cached_file.h"
#include "author/jobs/cached_values.h"
#include "base/hash.h"

namespace ibr {
namespace {

constexpr std::uint64_t kVersion = 3;     // raise when the same input gives different cells
constexpr const char* kKind = "aligned";  // of cache files

}  // namespace

std::uint64_t alignmentKey(const CellAlignmentInput& input, const AlignmentOptions& options) {
  Hash hash;
  hash.add(kVersion);
  hash.add(int(options.method));
  hash.add(int(options.definition));
  for (const double v : {double(options.instances), options.radiusPx, options.decay, options.threshold,
                         double(options.maxCycles), options.varianceFloor})
    hash.add(v);
  hash.add(options.levels);
  hash.add(options.escape);
  hash.add(options.epipolarWeight);
  hash.add(options.rigidity);
  hash.add(options.flipEdges);
  hash.add(options.flipGain);
  hash.add(options.insertPoints);
  for (const double v : {options.insertBelow, options.insertGain, options.insertShare}) hash.add(v);
  hash.add(options.prune);
  hash.add(options.scaledInstances);
  hash.add(options.seed);
  for (const MatchView& view : input.views) {
    const Intrinsics& k = view.camera.intrinsics;
    const Pose& pose = view.camera.pose;
    hash.add(int(k.model));
    if (!view.mask.empty()) hash.add(std::as_bytes(std::span(view.mask.values)));
    for (const double v : {double(k.width), double(k.height), k.fx, k.fy, k.cx, k.cy, pose.position.x, pose.position.y,
                           pose.position.z, pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z})
      hash.add(v);
    hash.add(std::as_bytes(std::span(view.picture.values)));
  }
  CacheWriter mesh;
  mesh.mesh(input.cell.mesh);
  hash.add(mesh.take());
  const CellQuality& quality = input.cell.quality;
  for (const double v : {quality.coverage, quality.ecc, quality.residualPx, quality.score}) hash.add(v);
  return hash.value();
}

void storeAligned(const std::filesystem::path& folder, std::uint64_t key, const AlignedCell& cell) {
  CacheWriter out;
  out.mesh(cell.mesh);
  out.value(cell.quality);
  const OptimisedCell& facts = cell.facts;
  for (const std::size_t v :
       {facts.points, facts.evaluated, facts.fixed, facts.moved, facts.flipped, facts.inserted, facts.reverted})
    out.value(std::uint64_t(v));
  const AlignmentSummary& summary = facts.summary;
  for (const double v : {summary.initialEcc, summary.finalEcc, summary.initialEccPaper, summary.finalEccPaper})
    out.value(v);
  out.list(summary.initialStarEcc);
  out.list(summary.finalStarEcc);
  out.list(summary.cycles);
  out.value(std::uint64_t(summary.bestCycle));
  out.value(std::uint64_t(summary.flips));
  out.value(std::uint64_t(summary.insertions));
  out.value(summary.seconds);
  storeCached(cacheFile(folder, key, kKind), out.take());
}

std::optional<AlignedCell> fetchAligned(const std::filesystem::path& folder, std::uint64_t key) {
  auto bytes = fetchCached(cacheFile(folder, key, kKind));
  if (!bytes) return std::nullopt;
  CacheReader in(std::move(*bytes));
  AlignedCell cell;
  cell.mesh = in.mesh();
  cell.quality = in.value<CellQuality>();
  OptimisedCell& facts = cell.facts;
  for (std::size_t* const v :
       {&facts.points, &facts.evaluated, &facts.fixed, &facts.moved, &facts.flipped, &facts.inserted, &facts.reverted})
    *v = in.value<std::uint64_t>();
  AlignmentSummary& summary = facts.summary;
  for (double* const v : {&summary.initialEcc, &summary.finalEcc, &summary.initialEccPaper, &summary.finalEccPaper})
    *v = in.value<double>();
  summary.initialStarEcc = in.list<float>();
  summary.finalStarEcc = in.list<float>();
  summary.cycles = in.list<AlignmentCycle>();
  summary.bestCycle = in.value<std::uint64_t>();
  summary.flips = in.value<std::uint64_t>();
  summary.insertions = in.value<std::uint64_t>();
  summary.seconds = in.value<double>();
  return cell;
}

}  // namespace ibr
