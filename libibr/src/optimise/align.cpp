// SPDX-License-Identifier: Apache-2.0
// The loop of [T] fig. 16.
//
//   E ← mean ECC of all stars in all pictures
//   repeat
//     each picture, each class of points that share no triangle, each of its points:
//       the best of M candidates within r; the point moves there unless it stands best already
//     edges are flipped, if that is asked for (topology.h)
//     E′ ← mean ECC; the mesh is kept if it is the best so far;  R ← R·D
//   until E′ − E <= t·max(|E|, 1/100), from the second cycle on
//
// Departure: in [T] the mean is summed up while points still move, starts at −1, and so ends the loop after one cycle
// (NUMERICS T6); it is measured after each cycle here.
#include <chrono>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "optimise/mover.h"
#include "optimise/topology.h"

namespace ibr {
namespace {

constexpr double kLeastScale = 0.01;  // of E in the stop rule, so that E near 0 or below ends, too

double secondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

struct MeanEcc {
  double channels = 0, concatenated = 0;
  std::vector<float> star;  // per channel and target, mean over pictures; NaN without a star
  double of(EccDefinition definition) const { return definition == EccDefinition::channels ? channels : concatenated; }
};

MeanEcc meanOf(const std::vector<Judgement>& all, const StarMesh& mesh, double varianceFloor) {
  const std::size_t n = mesh.pointCount(), d = mesh.memberCount();
  MeanEcc mean{0, 0, std::vector<float>(n, std::numeric_limits<float>::quiet_NaN())};
  std::size_t stars = 0;
  for (std::size_t p = 0; p < n; ++p) {
    if (mesh.star[p].empty()) continue;
    double star = 0;
    for (std::size_t i = 0; i < d; ++i) {
      const Judgement& judgement = all[i * n + p];
      star += eccOf(judgement.score(EccDefinition::channels, varianceFloor)) / double(d);
      mean.concatenated += eccOf(judgement.score(EccDefinition::concatenated, 0)) / double(d);
    }
    mean.star[p] = float(star);
    mean.channels += star;
    ++stars;
  }
  if (stars > 0) mean.channels /= double(stars), mean.concatenated /= double(stars);
  return mean;
}

std::unique_ptr<Mover> moverOf(const MoverInput& input, const Device* device) {
  switch (input.options.method) {
    case AlignmentMethod::cpu:
      return cpuMover(input);
    case AlignmentMethod::gradient:
      return gradientMover(input);
    case AlignmentMethod::compute:
      check(device != nullptr, ErrorCode::invalidInput, "alignment: this method needs a device");
      return computeMover(input, *device);
    case AlignmentMethod::raster:
      check(device != nullptr, ErrorCode::invalidInput, "alignment: this method needs a device");
      return rasterMover(input, *device);
  }
  fail(ErrorCode::invalidInput, "alignment: method {} is none", int(input.options.method));
}

// A mesh that moves, and may be joined anew.
class MovingMesh {
 public:
  MovingMesh(const Alignment& start, const AlignmentOptions& options, const Device* device)
      : start_(start), options_(options), device_(device), now_(start) {
    mesh_ = starMeshOf(start);
    for (const Image8* picture : start.pictures) pictures_.push_back(texelsOf(*picture));
    mover_ = moverOf({mesh_, pictures_, options_, start_}, device_);
    coarse_ = mover_->coarseCycles();
  }
  MovingMesh(const MovingMesh&) = delete;

  const Alignment& now() const { return now_; }
  int coarseCycles() const { return coarse_; }
  MeanEcc mean() { return meanOf(mover_->judgeAll(now_.position), mesh_, options_.varianceFloor); }
  CycleCounts cycle(const CycleRequest& request, const KeepGoing& keepGoing) {
    return mover_->cycle(request, now_.position, keepGoing);
  }

  /// Only after the coarse cycles: the new mover has none.
  std::size_t flip() {
    const std::size_t flips =
        flipEdges(now_, pictures_, {options_.flipGain, options_.varianceFloor, kFlipPasses, options_.threads});
    if (flips == 0) return 0;
    mover_.reset();
    options_.levels = 1;
    mesh_ = starMeshOf(now_);
    mover_ = moverOf({mesh_, pictures_, options_, start_}, device_);
    return flips;
  }

 private:
  static constexpr int kFlipPasses = 8;

  const Alignment& start_;
  AlignmentOptions options_;
  const Device* device_;
  Alignment now_;
  StarMesh mesh_;
  std::vector<Texels> pictures_;
  std::unique_ptr<Mover> mover_;  // of mesh_
  int coarse_ = 0;
};

}  // namespace

std::string optionsFault(const AlignmentOptions& o) {
  const auto within = [](double value, double least, double most) { return value >= least && value <= most; };
  if (!within(o.instances, 2, 256)) return fmt::format("instances {}: 2 to 256", o.instances);
  if (!(o.radiusPx > 0 && o.radiusPx <= 64)) return fmt::format("radius {} px: above 0, at most 64", o.radiusPx);
  if (!(o.decay > 0 && o.decay <= 1)) return fmt::format("decay {}: above 0, at most 1", o.decay);
  if (!(o.threshold >= 0 && std::isfinite(o.threshold))) return fmt::format("threshold {}: at least 0", o.threshold);
  if (o.mostCycles < 1) return fmt::format("cycles {}: at least 1", o.mostCycles);
  if (!within(o.rigidity, 0, 10000)) return fmt::format("rigidity {}: 0 to 10000", o.rigidity);
  if (!within(o.levels, 1, 8)) return fmt::format("levels {}: 1 to 8", o.levels);
  if (!within(o.escape, 0, 256)) return fmt::format("escape {}: 0 to 256", o.escape);
  if (!within(o.epipolarWeight, 0, 10000)) return fmt::format("epipolar weight {}: 0 to 10000", o.epipolarWeight);
  if (!within(o.flipGain, 0, 1)) return fmt::format("flip gain {}: 0 to 1", o.flipGain);
  if (!within(o.varianceFloor, 0, 1000)) return fmt::format("variance floor {}: 0 to 1000", o.varianceFloor);
  return {};
}

AlignmentSummary align(Alignment& alignment, const AlignmentOptions& options, const Device* device,
                       const ProgressCallback& progress) {
  const auto start = std::chrono::steady_clock::now();
  const std::string fault = optionsFault(options);
  check(fault.empty(), ErrorCode::invalidInput, "alignment: {}", fault);
  MovingMesh mesh(alignment, options, device);

  AlignmentSummary summary;
  const auto keepGoing = [&] {
    const Progress now{"aligning", summary.cycles.size(), 0};
    check(!progress || progress(now), ErrorCode::cancelled, "alignment: cancelled");
  };
  Positions bestPosition = alignment.position;
  std::vector<glm::uvec3> bestTriangles = alignment.triangles;
  MeanEcc last = mesh.mean(), bestMean = last;
  std::size_t flips = 0;
  summary.initialEcc = last.channels;
  summary.initialEccPaper = last.concatenated;
  summary.starEccBefore = last.star;

  const std::uint32_t seed = shader::eccHash(std::uint32_t(options.seed), std::uint32_t(options.seed >> 32));
  double radius = options.radiusPx * kAlignmentUnitsPerPixel;
  for (int c = 0; c < options.mostCycles; ++c, radius *= options.decay) {
    const auto cycleStart = std::chrono::steady_clock::now();
    const CycleRequest request{std::max(int(radius), 1), shader::eccHash(seed, std::uint32_t(c))};
    const CycleCounts counts = mesh.cycle(request, keepGoing);
    const int finer = c - mesh.coarseCycles();
    const std::size_t flipped = options.flipEdges && finer >= 0 ? mesh.flip() : 0;
    flips += flipped;
    const MeanEcc mean = mesh.mean();
    const double ecc = mean.of(options.definition), before = last.of(options.definition);
    summary.cycles.push_back({double(request.radius) / kAlignmentUnitsPerPixel, ecc, counts.mutations, counts.pixels,
                              counts.moved, counts.refused, secondsSince(cycleStart), flipped});
    last = mean;
    if (ecc > bestMean.of(options.definition)) {
      bestPosition = mesh.now().position;
      bestTriangles = mesh.now().triangles;
      bestMean = mean;
      summary.bestCycle = std::size_t(c) + 1;
      summary.flips = flips;
    }
    const bool stalled = ecc - before <= options.threshold * std::max(std::abs(before), kLeastScale);
    if (finer >= 0 && (counts.moved + flipped == 0 || (finer > 0 && stalled))) break;
  }
  alignment.position = std::move(bestPosition);
  alignment.triangles = std::move(bestTriangles);
  summary.finalEcc = bestMean.channels;
  summary.finalEccPaper = bestMean.concatenated;
  summary.starEccAfter = bestMean.star;
  summary.seconds = secondsSince(start);
  return summary;
}

}  // namespace ibr
