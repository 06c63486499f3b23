// SPDX-License-Identifier: Apache-2.0
// The alignment loop of [T] fig. 16.
//
//   E ← mean ECC of all stars in all images
//   repeat
//     each image, each class of points that share no triangle, each of its points:
//       the best of M candidates within r; the point moves there unless its position is the best
//     flip edges (topology.h) and insert points (insertion.h), if the options request them
//     E′ ← mean ECC; keep the mesh if it is the best so far;  R ← R·D
//   until E′ − E <= t·max(|E|, 1/100), from the second cycle on
//
// Departure: [T] sums the mean up while points still move and starts from −1, which ends the loop after one cycle. Here
// the mean is measured after each cycle.
#include <chrono>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "optimise/alignment_backend.h"
#include "optimise/insertion.h"
#include "optimise/topology.h"

namespace ibr {
namespace {

constexpr std::uint32_t kInsertionSeed = 0x1b5e;  // derives the insertion's seed from the cycle's
constexpr double kMinScale = 0.01;                // of E in the stop criterion, so that an E near 0 or below ends, too

double secondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

struct MeanEcc {
  double channels = 0, concatenated = 0;
  std::vector<float> star;  // per channel and target, mean over images; NaN without a star
  double of(EccDefinition definition) const { return definition == EccDefinition::channels ? channels : concatenated; }
};

// Mean ECC over the stars of the first `points` points.
MeanEcc meanOf(const std::vector<Judgement>& all, const StarMesh& mesh, double varianceFloor, std::size_t points) {
  const std::size_t n = mesh.vertexCount(), d = mesh.memberCount();
  MeanEcc mean{0, 0, std::vector<float>(n, std::numeric_limits<float>::quiet_NaN())};
  std::size_t stars = 0;
  for (std::size_t p = 0; p < n; ++p) {
    if (mesh.star[p].empty()) continue;
    const bool counts = p < points;
    double star = 0;
    for (std::size_t i = 0; i < d; ++i) {
      const Judgement& judgement = all[i * n + p];
      star += eccOf(judgement.score(EccDefinition::channels, varianceFloor)) / double(d);
      if (counts) mean.concatenated += eccOf(judgement.score(EccDefinition::concatenated, 0)) / double(d);
    }
    mean.star[p] = float(star);
    if (!counts) continue;
    mean.channels += star;
    ++stars;
  }
  if (stars > 0) mean.channels /= double(stars), mean.concatenated /= double(stars);
  return mean;
}

std::unique_ptr<AlignmentBackend> makeBackend(const BackendInput& input, const Device* device) {
  switch (input.options.method) {
    case AlignmentMethod::cpu:
      return makeCpuBackend(input);
    case AlignmentMethod::gradient:
      return makeGradientBackend(input);
    case AlignmentMethod::compute:
      check(device != nullptr, ErrorCode::invalidInput, "alignment: method compute requires a device");
      return makeComputeBackend(input, *device);
    case AlignmentMethod::raster:
      check(device != nullptr, ErrorCode::invalidInput, "alignment: method raster requires a device");
      return makeRasterBackend(input, *device);
  }
  fail(ErrorCode::invalidInput, "alignment: unknown method {}", int(input.options.method));
}

// A mesh whose points move, whose edges flip and which gains points.
class MovingMesh {
 public:
  MovingMesh(const Alignment& start, const AlignmentOptions& options, const Device* device)
      : options_(options), device_(device), start_(start), now_(start) {
    mesh_ = starMeshOf(start);
    for (const Image8* picture : start.pictures) pictures_.push_back(texelsOf(*picture));
    backend_ = makeBackend({mesh_, pictures_, options_, start_}, device_);
    coarse_ = backend_->coarseCycles();
    points_ = mesh_.vertexCount();
  }
  MovingMesh(const MovingMesh&) = delete;

  const Alignment& now() const { return now_; }
  int coarseCycles() const { return coarse_; }
  MeanEcc mean() { return meanOf(backend_->judgeAll(now_.position), mesh_, options_.varianceFloor, points_); }
  CycleCounts cycle(const CycleRequest& request, const KeepGoing& keepGoing) {
    return backend_->cycle(request, now_.position, keepGoing);
  }

  struct Changed {
    std::size_t flipped = 0, inserted = 0;
  };
  /// Flips edges and inserts points as the options request. Only after the coarse cycles: the new mover has none.
  Changed flipAndInsert(std::uint32_t seed, const KeepGoing& keepGoing) {
    Changed changed;
    if (options_.flipEdges)
      changed.flipped =
          flipEdges(now_, pictures_, {options_.flipGain, options_.varianceFloor, kFlipPasses, options_.threads});
    Positions began = std::move(start_.position);
    if (options_.insertPoints) {
      const std::size_t most = points_ + std::size_t(options_.insertShare * double(points_));
      const InsertRequest request{most - now_.position[0].size(), int(options_.radiusPx * kAlignmentUnitsPerPixel),
                                  seed};
      changed.inserted = insertPoints(now_, began, pictures_, options_, request, keepGoing);
    }
    if (changed.inserted > 0) start_ = now_;
    start_.position = std::move(began);
    if (changed.flipped + changed.inserted == 0) return changed;
    backend_.reset();
    options_.levels = 1;
    mesh_ = starMeshOf(now_);
    backend_ = makeBackend({mesh_, pictures_, options_, start_}, device_);
    return changed;
  }

 private:
  static constexpr int kFlipPasses = 8;

  AlignmentOptions options_;
  const Device* device_;
  Alignment start_;  // start position of each point; of an inserted point, before its search
  Alignment now_;
  StarMesh mesh_;
  std::vector<Texels> pictures_;
  std::unique_ptr<AlignmentBackend> backend_;  // for mesh_
  int coarse_ = 0;
  std::size_t points_ = 0;  // number before any insertion
};

}  // namespace

std::string firstInvalidOption(const AlignmentOptions& o) {
  const auto within = [](double value, double least, double most) { return value >= least && value <= most; };
  if (!within(o.instances, 2, 256)) return fmt::format("instances {}: must be 2 to 256", o.instances);
  if (!(o.radiusPx > 0 && o.radiusPx <= 64))
    return fmt::format("radiusPx {}: must be above 0 and at most 64", o.radiusPx);
  if (!(o.decay > 0 && o.decay <= 1)) return fmt::format("decay {}: must be above 0 and at most 1", o.decay);
  if (!(o.threshold >= 0 && std::isfinite(o.threshold)))
    return fmt::format("threshold {}: must be at least 0", o.threshold);
  if (o.maxCycles < 1) return fmt::format("maxCycles {}: must be at least 1", o.maxCycles);
  if (!within(o.rigidity, 0, 10000)) return fmt::format("rigidity {}: must be 0 to 10000", o.rigidity);
  if (!within(o.levels, 1, 8)) return fmt::format("levels {}: must be 1 to 8", o.levels);
  if (!within(o.escape, 0, 256)) return fmt::format("escape {}: must be 0 to 256", o.escape);
  if (!within(o.epipolarWeight, 0, 10000))
    return fmt::format("epipolarWeight {}: must be 0 to 10000", o.epipolarWeight);
  if (!within(o.flipGain, 0, 1)) return fmt::format("flipGain {}: must be 0 to 1", o.flipGain);
  if (!within(o.insertBelow, -1, 1)) return fmt::format("insertBelow {}: must be -1 to 1", o.insertBelow);
  if (!within(o.insertGain, 0, 1)) return fmt::format("insertGain {}: must be 0 to 1", o.insertGain);
  if (!within(o.insertShare, 0, 4)) return fmt::format("insertShare {}: must be 0 to 4", o.insertShare);
  if (!within(o.varianceFloor, 0, 1000)) return fmt::format("varianceFloor {}: must be 0 to 1000", o.varianceFloor);
  return {};
}

AlignmentSummary align(Alignment& alignment, const AlignmentOptions& options, const Device* device,
                       const ProgressCallback& progress) {
  const auto start = std::chrono::steady_clock::now();
  const std::string fault = firstInvalidOption(options);
  check(fault.empty(), ErrorCode::invalidInput, "alignment: {}", fault);
  MovingMesh mesh(alignment, options, device);

  AlignmentSummary summary;
  const auto keepGoing = [&] {
    const Progress now{"aligning", summary.cycles.size(), 0};
    check(!progress || progress(now), ErrorCode::cancelled, "alignment: cancelled");
  };
  Alignment best = alignment;
  MeanEcc last = mesh.mean(), bestMean = last;
  std::size_t flips = 0, insertions = 0;
  summary.initialEcc = last.channels;
  summary.initialEccPaper = last.concatenated;
  summary.initialStarEcc = last.star;

  const std::uint32_t seed = shader::eccHash(std::uint32_t(options.seed), std::uint32_t(options.seed >> 32));
  double radius = options.radiusPx * kAlignmentUnitsPerPixel;
  for (int c = 0; c < options.maxCycles; ++c, radius *= options.decay) {
    const auto cycleStart = std::chrono::steady_clock::now();
    const CycleRequest request{std::max(int(radius), 1), shader::eccHash(seed, std::uint32_t(c))};
    const CycleCounts counts = mesh.cycle(request, keepGoing);
    const int finer = c - mesh.coarseCycles();
    const auto changed = finer >= 0 ? mesh.flipAndInsert(shader::eccHash(request.seed, kInsertionSeed), keepGoing)
                                    : MovingMesh::Changed{};
    flips += changed.flipped;
    insertions += changed.inserted;
    const MeanEcc mean = mesh.mean();
    const double ecc = mean.of(options.definition), before = last.of(options.definition);
    summary.cycles.push_back({double(request.radius) / kAlignmentUnitsPerPixel, ecc, counts.mutations, counts.pixels,
                              counts.moved, counts.refused, secondsSince(cycleStart), changed.flipped,
                              changed.inserted});
    last = mean;
    if (ecc > bestMean.of(options.definition)) {
      best = mesh.now();
      bestMean = mean;
      summary.bestCycle = std::size_t(c) + 1;
      summary.flips = flips;
      summary.insertions = insertions;
    }
    const bool stalled = ecc - before <= options.threshold * std::max(std::abs(before), kMinScale);
    if (finer >= 0 && (counts.moved + changed.flipped + changed.inserted == 0 || (finer > 0 && stalled))) break;
  }
  alignment = std::move(best);
  summary.initialStarEcc.resize(bestMean.star.size(), std::numeric_limits<float>::quiet_NaN());
  summary.finalEcc = bestMean.channels;
  summary.finalEccPaper = bestMean.concatenated;
  summary.finalStarEcc = bestMean.star;
  summary.seconds = secondsSince(start);
  return summary;
}

}  // namespace ibr
