// SPDX-License-Identifier: Apache-2.0
// The loop of [T] fig. 16.
//
//   E ← mean ECC of all stars in all pictures
//   repeat
//     each picture, each class of points that share no triangle, each of its points:
//       the best of M candidates within r; the point moves there unless it stands best already
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
    default:
      fail(ErrorCode::unsupported, "this method of alignment is not there yet");
  }
}

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
  if (!within(o.varianceFloor, 0, 1000)) return fmt::format("variance floor {}: 0 to 1000", o.varianceFloor);
  return {};
}

AlignmentSummary align(Alignment& alignment, const AlignmentOptions& options, const Device* device,
                       const ProgressCallback& progress) {
  const auto start = std::chrono::steady_clock::now();
  const std::string fault = optionsFault(options);
  check(fault.empty(), ErrorCode::invalidInput, "alignment: {}", fault);
  const StarMesh mesh = starMeshOf(alignment);
  std::vector<Texels> pictures;
  for (const Image8* picture : alignment.pictures) pictures.push_back(texelsOf(*picture));
  const std::unique_ptr<Mover> mover = moverOf({mesh, pictures, options, alignment}, device);

  AlignmentSummary summary;
  const auto keepGoing = [&] {
    const Progress now{"aligning", summary.cycles.size(), 0};
    check(!progress || progress(now), ErrorCode::cancelled, "alignment: cancelled");
  };
  Positions at = alignment.position, best = at;
  MeanEcc last = meanOf(mover->judgeAll(at), mesh, options.varianceFloor), bestMean = last;
  summary.initialEcc = last.channels;
  summary.initialEccPaper = last.concatenated;
  summary.starEccBefore = last.star;

  const std::uint32_t seed = shader::eccHash(std::uint32_t(options.seed), std::uint32_t(options.seed >> 32));
  double radius = options.radiusPx * kAlignmentUnitsPerPixel;
  for (int c = 0; c < options.mostCycles; ++c, radius *= options.decay) {
    const auto cycleStart = std::chrono::steady_clock::now();
    const CycleRequest request{std::max(int(radius), 1), shader::eccHash(seed, std::uint32_t(c))};
    const CycleCounts counts = mover->cycle(request, at, keepGoing);
    const MeanEcc mean = meanOf(mover->judgeAll(at), mesh, options.varianceFloor);
    const double ecc = mean.of(options.definition), before = last.of(options.definition);
    summary.cycles.push_back({double(request.radius) / kAlignmentUnitsPerPixel, ecc, counts.mutations, counts.pixels,
                              counts.moved, counts.refused, secondsSince(cycleStart)});
    last = mean;
    if (ecc > bestMean.of(options.definition)) best = at, bestMean = mean, summary.bestCycle = std::size_t(c) + 1;
    const bool stalled = ecc - before <= options.threshold * std::max(std::abs(before), kLeastScale);
    const int finer = c - mover->coarseCycles();
    if (finer >= 0 && (counts.moved == 0 || (finer > 0 && stalled))) break;
  }
  alignment.position = std::move(best);
  summary.finalEcc = bestMean.channels;
  summary.finalEccPaper = bestMean.concatenated;
  summary.starEccAfter = bestMean.star;
  summary.seconds = secondsSince(start);
  return summary;
}

}  // namespace ibr
