// SPDX-License-Identifier: Apache-2.0
#include "author/build/build_cost.h"

#include <algorithm>

#include "author/exposure/exposure_overlap.h"

namespace ibr {
namespace {

// Processor time of the machine that they were measured on, ns a pixel, and s.
constexpr double kRead = 10, kEncode = 18;
constexpr double kMips = 20, kBc1 = 150, kBc7 = 430;
constexpr double kFeatures = 450, kPair = 0.005;
constexpr double kOnce = 170, kMember = 193, kLevel = 4.4, kLevelMember = 2;
constexpr double kBackdrop = 130;
constexpr double kSweep = 4500, kRefine = 4500, kConfirm = 400;  // a pixel of the depth maps
constexpr double kObservation = 150e-6;                          // of a point, while poses are refined
constexpr double kExposurePoint = 15e-6, kSolvingShare = 0.2;    // of a point in two photographs; one thread solves
constexpr double kJudged = 250, kJudge = 240;  // a pixel of a photograph, and of each that it is compared with

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
  // `longest`: a job that cannot be shared out.
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
  add("finding what moved", judging, threads.movers, judging / photographs);
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
  add("refining poses", kObservation * work.refinedBy, 1, 0);  // after it, cells are made once more
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
  constexpr double kFrame = 70, kOfMember = 12, kOfLevel = 0.75;  // a pixel of the frame; costs are of half its size
  constexpr double kOther = 300;
  constexpr double kInFull = 8;  // a pixel beyond the matched ones: RGB once, grey of four
  const double pixel = cell.swept ? kFrame + kOfMember * double(cell.members) + kOfLevel * cell.levels : kOther;
  return cell.loadingBytes + pixel * cell.pixels + kInFull * cell.beyondPixels;
}

double bytesToCompareExposures(const BuildWork& work) {
  constexpr double kBytesPerPoint = 500;  // where it is looked at, what is seen, what is solved
  return work.exposures ? kBytesPerPoint * double(mostOverlapPoints(work.photographs)) : 0;
}

double bytesKept(const CellWork& cell) {
  constexpr double kBytesPerPixel = 2;
  return kBytesPerPixel * cell.pixels;
}

}  // namespace ibr
