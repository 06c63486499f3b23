// SPDX-License-Identifier: Apache-2.0
#include "author/build/build_cost.h"

#include <algorithm>

#include "author/exposure/exposure_overlap.h"

namespace ibr {
namespace {

// Processor time on the machine of the measurement: ns per pixel, or s where noted.
constexpr double kReadNs = 10, kEncodeNs = 18;
constexpr double kMipsNs = 20, kBc1Ns = 150, kBc7Ns = 430;
constexpr double kFeaturesNs = 450, kPairSeconds = 0.005;  // kPairSeconds: s per pair of photographs
constexpr double kCellPixelNs = 170, kMemberNs = 193, kLevelNs = 4.4, kLevelMemberNs = 2;
constexpr double kBackdropNs = 130;
constexpr double kSampleNs = 25, kMapNs = 40;  // per pixel sampled from a panorama; per pixel of a depth map drawn
constexpr double kSourcePointNs = 20;          // per point and view
constexpr double kSweepNs = 4500, kRefineNs = 4500, kConfirmNs = 400;  // per pixel of the depth maps
constexpr double kObservationSeconds = 150e-6;                         // s per observation, for refining poses
constexpr double kExposurePointSeconds = 15e-6,
                 kSerialShare = 0.2;  // s per point in two photographs; the solve is serial
constexpr double kComparedNs = 250,
                 kComparisonNs = 240;  // per pixel of a photograph, and of each that it is compared with

double textureNs(TextureFormat format) {
  return kMipsNs + (format == TextureFormat::bc1 ? kBc1Ns : format == TextureFormat::bc7 ? kBc7Ns : 0);
}

double cellSeconds(const CellWork& cell) {
  const double m = double(cell.members);
  const double frame = cell.pixels * (kCellPixelNs + kMemberNs * m + cell.levels * (kLevelNs + kLevelMemberNs * m)) +
                       kMapNs * cell.mapPixels;
  return 1e-9 * (kReadNs * cell.readPixels + kSampleNs * cell.sampledPixels + std::max(cell.faces, 1.0) * frame);
}

}  // namespace

std::vector<StageCost> costOf(const BuildWork& work, const StageThreads& threads, TextureFormat texture,
                              const MachineSpeed& speed) {
  std::vector<StageCost> stages;
  // `longest`: duration of a job that cannot be divided among threads.
  const auto add = [&](const char* stage, double seconds, int side, double longest) {
    if (seconds <= 0) return;
    stages.push_back({stage, seconds * speed.cpu, speed.elapsed * std::max(seconds / side, longest)});
  };
  const double photographs = double(std::max<std::size_t>(work.photographs, 1));
  const double storing =
      1e-9 * (kReadNs * work.readPixels + textureNs(texture) * work.storedPixels + kEncodeNs * work.encodedPixels);
  add("storing photographs", storing, threads.storing, storing / photographs);
  add("finding features", 1e-9 * kFeaturesNs * work.featurePixels, threads.features, 0);
  add("matching features", kPairSeconds * double(work.pairs), threads.features, 0);
  const double comparing = 1e-9 * ((kSweepNs + kConfirmNs) * work.comparedSweptPixels +
                                   kComparedNs * work.comparedPixels + kComparisonNs * work.comparisonPixels);
  add("finding moving objects", comparing, threads.movers, comparing / photographs);
  double cells = 0, longest = 0;
  for (const std::vector<CellWork>* list : {&work.sweptCells, &work.cells})
    for (const CellWork& cell : *list) {
      cells += cellSeconds(cell);
      longest = std::max(longest, cellSeconds(cell));
    }
  const double each = 1 / photographs;
  add("planning depth", 1e-9 * kSourcePointNs * work.sourcePoints, threads.backdrops, 0);
  const double sampling = 1e-9 * kSampleNs * work.facePixels;
  add("sampling panoramas", sampling, threads.backdrops, sampling * each);
  const auto addDepth = [&](const char* stage, double nanoseconds, double pixels) {
    const double seconds = 1e-9 * nanoseconds * pixels;
    add(stage, seconds, threads.backdrops, seconds * each);
  };
  const double swept = std::max(work.sweptPixels, 1.0);
  addDepth("finding depth", kSweepNs * (1 + work.extraSweptPixels / swept) + kRefineNs * work.refinements,
           work.sweptPixels);
  const auto addConfirmed = [&](double pixels) { addDepth("confirming depth", kConfirmNs, pixels); };
  addConfirmed(work.sweptPixels);
  add("matching cells", cells, threads.cells, longest);
  add("refining poses", kObservationSeconds * work.refinementObservations, 1, 0);
  if (work.sweptPixels == 0) addConfirmed(work.backdropPixels);
  if (work.exposures) {
    const double points = kExposurePointSeconds * double(maxOverlapPoints(work.photographs));
    add("comparing exposures", 1e-9 * kReadNs * work.readPixels + points, threads.storing, kSerialShare * points);
  }
  const double backdrops =
      double(work.backdrops) > 0 ? 1e-9 * (kBackdropNs * work.backdropPixels + kReadNs * work.readPixels) : 0;
  add("completing backdrops", backdrops, threads.backdrops, backdrops * each);
  return stages;
}

double bytesToMake(const CellWork& cell) {
  constexpr double kFrameBytes = 70, kMemberBytes = 12,
                   kLevelBytes = 0.75;  // bytes per pixel; cost volumes have half the sides
  constexpr double kUnsweptBytes = 300;
  constexpr double kExcessBytes = 8;  // bytes per pixel beyond the matched size: RGB, grey
  if (cell.faces > 0) {               // all faces with their matches, and the work on one of them
    constexpr double kHeldBytes = 5, kHeldMemberBytes = 12, kWorkBytes = 120, kPictureBytes = 3, kMapBytes = 4;
    const double m = double(cell.members);
    return cell.loadingBytes + kPictureBytes * cell.heldPixels + kMapBytes * cell.mapPixels +
           cell.pixels * (cell.faces * (kHeldBytes + kHeldMemberBytes * m) + kWorkBytes + kLevelBytes * cell.levels);
  }
  const double pixel =
      cell.swept ? kFrameBytes + kMemberBytes * double(cell.members) + kLevelBytes * cell.levels : kUnsweptBytes;
  return cell.loadingBytes + pixel * cell.pixels + kExcessBytes * cell.excessPixels;
}

double bytesToCompareExposures(const BuildWork& work) {
  constexpr double kBytesPerPoint = 500;  // of positions, samples and the solver
  return work.exposures ? kBytesPerPoint * double(maxOverlapPoints(work.photographs)) : 0;
}

double cachedCellBytes(const CellWork& cell) {
  constexpr double kBytesPerPixel = 2;
  return kBytesPerPixel * std::max(cell.faces, 1.0) * cell.pixels;
}

}  // namespace ibr
