// SPDX-License-Identifier: Apache-2.0
#include "author/build/build_cost.h"

#include <algorithm>

#include "author/exposure/exposure_overlap.h"

namespace ibr {
namespace {

// Processor time on the machine of the measurement: ns per pixel, or s where noted.
constexpr double kRead = 10, kEncode = 18;
constexpr double kMips = 20, kBc1 = 150, kBc7 = 430;
constexpr double kFeatures = 450, kPair = 0.005;  // kPair: s per pair of photographs
constexpr double kOnce = 170, kMember = 193, kLevel = 4.4, kLevelMember = 2;
constexpr double kBackdrop = 130;
constexpr double kSweep = 4500, kRefine = 4500, kConfirm = 400;  // per pixel of the depth maps
constexpr double kObservation = 150e-6;                          // s per observation, for refining poses
constexpr double kExposurePoint = 15e-6, kSolvingShare = 0.2;    // s per point in two photographs; the solve is serial
constexpr double kJudged = 250, kJudge = 240;  // per pixel of a photograph, and of each that it is compared with

double perPixel(TextureFormat format) {
  return kMips + (format == TextureFormat::bc1 ? kBc1 : format == TextureFormat::bc7 ? kBc7 : 0);
}

double cellSeconds(const CellWork& cell) {
  const double m = double(cell.members);
  return 1e-9 *
         (kRead * cell.readPixels + cell.pixels * (kOnce + kMember * m + cell.levels * (kLevel + kLevelMember * m)));
}

}  // namespace

std::vector<StageCost> costOf(const BuildWork& work, const StageThreads& threads, TextureFormat texture,
                              const MachineSpeed& speed) {
  std::vector<StageCost> stages;
  // `longest`: duration of a job that cannot be divided among threads.
  const auto add = [&](const char* stage, double seconds, int side, double longest) {
    if (seconds <= 0) return;
    stages.push_back({stage, seconds * speed.processor, speed.passing * std::max(seconds / side, longest)});
  };
  const double photographs = double(std::max<std::size_t>(work.photographs, 1));
  const double storing =
      1e-9 * (kRead * work.readPixels + perPixel(texture) * work.storedPixels + kEncode * work.encodedPixels);
  add("storing photographs", storing, threads.storing, storing / photographs);
  add("finding features", 1e-9 * kFeatures * work.featurePixels, threads.features, 0);
  add("matching features", kPair * double(work.pairs), threads.features, 0);
  const double judging =
      1e-9 * ((kSweep + kConfirm) * work.judgedSweptPixels + kJudged * work.judgedPixels + kJudge * work.judgePixels);
  add("finding moving objects", judging, threads.movers, judging / photographs);
  double cells = 0, longest = 0;
  for (const CellWork& cell : work.cells) {
    cells += cellSeconds(cell);
    longest = std::max(longest, cellSeconds(cell));
  }
  const double each = 1 / photographs;
  const auto addDepth = [&](const char* stage, double nanoseconds, double pixels) {
    const double seconds = 1e-9 * nanoseconds * pixels;
    add(stage, seconds, threads.backdrops, seconds * each);
  };
  addDepth("finding depth", kSweep + kRefine * work.refinements, work.sweptPixels);
  const auto addConfirmed = [&](double pixels) { addDepth("confirming depth", kConfirm, pixels); };
  addConfirmed(work.sweptPixels);
  add("matching cells", cells, threads.cells, longest);
  add("refining poses", kObservation * work.refinedBy, 1, 0);  // cells are made again afterwards
  if (work.sweptPixels == 0) addConfirmed(work.backdropPixels);
  if (work.exposures) {
    const double points = kExposurePoint * double(mostOverlapPoints(work.photographs));
    add("comparing exposures", 1e-9 * kRead * work.readPixels + points, threads.storing, kSolvingShare * points);
  }
  const double backdrops =
      double(work.backdrops) > 0 ? 1e-9 * (kBackdrop * work.backdropPixels + kRead * work.readPixels) : 0;
  add("completing backdrops", backdrops, threads.backdrops, backdrops * each);
  return stages;
}

double bytesToMake(const CellWork& cell) {
  constexpr double kFrame = 70, kOfMember = 12, kOfLevel = 0.75;  // bytes per pixel; cost volumes have half the sides
  constexpr double kOther = 300;
  constexpr double kInFull = 8;  // bytes per pixel beyond the matched size: RGB, grey
  const double pixel = cell.swept ? kFrame + kOfMember * double(cell.members) + kOfLevel * cell.levels : kOther;
  return cell.loadingBytes + pixel * cell.pixels + kInFull * cell.beyondPixels;
}

double bytesToCompareExposures(const BuildWork& work) {
  constexpr double kBytesPerPoint = 500;  // of positions, samples and the solver
  return work.exposures ? kBytesPerPoint * double(mostOverlapPoints(work.photographs)) : 0;
}

double bytesKept(const CellWork& cell) {
  constexpr double kBytesPerPixel = 2;
  return kBytesPerPixel * cell.pixels;
}

}  // namespace ibr
