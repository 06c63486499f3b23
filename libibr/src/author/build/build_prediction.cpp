// SPDX-License-Identifier: Apache-2.0
#include "author/build/build_prediction.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "author/backdrop/backdrop.h"
#include "author/build/backdrop_maker.h"
#include "author/build/build_cost.h"
#include "author/build/cell_maker.h"
#include "author/build/depth_matcher.h"
#include "author/build/find_movers.h"
#include "author/build/machine_speed.h"
#include "author/build/own_tracks.h"
#include "author/build/sweep_plan.h"
#include "author/depth/depth_views.h"
#include "author/depth/photograph_sweep.h"
#include "author/geometry/posed_model.h"
#include "base/check.h"
#include "base/file.h"
#include "base/parallel.h"
#include "base/usage.h"
#include "ibr/author/photographs.h"
#include "image/depth_texture.h"
#include "io/image_file.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

constexpr double kTypicalLevels = 100;  // assumed for cells that are not planned yet
constexpr std::size_t kTypicalMembers = 3;
constexpr double kPngBytesPerPixel = 2, kJpegBytesPerPixel = 0.8;  // bytes per pixel of an encoded image
constexpr double kCachedFeatureBytes = 3e6;                        // bytes of a photograph's cached features
constexpr double kCachedDepthBytesPerPixel = 5;                    // bytes per pixel of a cached depth map
constexpr double kOwnObservationsPerPhotograph = 2000;             // of own tracks
constexpr double kObservationsPerPhotograph = 700;                 // observations of dense tracks per photograph
constexpr double kProgramBytes = 60e6;                             // memory of the program itself, bytes

double pixelsOf(const Intrinsics& k) {
  return double(k.width) * k.height;
}

double textureBytesOf(TextureFormat format, const Intrinsics& k) {
  double bytes = 0;
  for (int w = k.width, h = k.height;; w = std::max(w / 2, 1), h = std::max(h / 2, 1)) {
    bytes += double(textureBytes(format, w, h));
    if (w == 1 && h == 1) return bytes;
  }
}

double freeDiskBytes(fs::path folder) {
  std::error_code error;
  folder = fs::absolute(folder, error);
  while (!fs::exists(folder, error) && folder.has_relative_path()) folder = folder.parent_path();
  const fs::space_info space = fs::space(folder, error);
  return error ? 0 : double(space.available);
}

// Bytes that an earlier build of this scene left in the output. This build replaces the files, so these bytes count as
// free.
double reusableBytes(const BuildOptions& options) {
  double bytes = 0;
  for (const char* part : {"cells", "images", "textures", "masks", "depth"})
    bytes += folderBytes(options.output / part);
  return bytes;
}

class Predictor {
 public:
  Predictor(const BuildInput& input, const BuildOptions& options, const CellPlan* plan)
      : input_(input), options_(options), plan_(plan), maker_(input, options) {}

  BuildPrediction predict() {
    countPhotographs();
    countTracks();
    countDepthSources();
    countLevels();
    if (options_.maskMovingObjects) countMovers();
    countCells();
    countRefinement();
    work_.exposures = options_.matchExposures || options_.fitVignetting;
    work_.photographs = made_.photographs = input_.photographs.size();
    made_.memoryLimitBytes = memoryBudget(options_.memory);
    made_.diskFreeBytes = freeDiskBytes(options_.output) + reusableBytes(options_);
    assignThreads();
    return std::move(made_);
  }

 private:
  void countDepth(const Photograph& photo) {
    reading_ = std::max(reading_, bytesToReadViews(photo));
    const double sweptShare = options_.depth == DepthSearch::fast ? kFastScale * kFastScale : 1;
    const double fineShare = options_.depth < DepthSearch::refined ? 0 : 1;
    for (const DepthView& view : depthViews({&photo.camera, 1})) {
      const glm::ivec2 swept = sweptSize(view.camera.intrinsics);
      const double pixels = sweptShare * swept.x * swept.y;
      work_.sweptPixels += pixels;
      const Intrinsics& face = view.camera.intrinsics;  // sampled at its full size for each image that is made of it
      if (view.isFace) work_.facePixels += (1 + fineShare) * double(face.width) * face.height;
      made_.disk += kCachedDepthBytesPerPixel * finePixelFactor(options_.depth) * swept.x * swept.y;
      depths_ += kViewBytesPerPixel * pixels;
      sweeping_ = std::max(sweeping_, kSweptBytesPerPixel * pixels);
    }
  }

  void countPhotographs() {
    for (const Photograph& photo : input_.photographs) {
      const Intrinsics& k = photo.camera.intrinsics;
      work_.readPixels += photo.sourcePixels;
      work_.storedPixels += pixelsOf(k);
      std::error_code ignored;
      const double file = double(fs::file_size(photo.source, ignored));
      made_.disk += textureBytesOf(options_.texture, k);
      if (!photo.copied) work_.encodedPixels += pixelsOf(k);
      made_.disk +=
          photo.copied ? file : (isJpeg(photo.imageFile) ? kJpegBytesPerPixel : kPngBytesPerPixel) * pixelsOf(k);
      storing_ = std::max(storing_, bytesToStore(photo));
      loading_ = std::max(loading_, bytesToLoad(photo));
      const glm::ivec2 size = backdropSize(k);
      const double whole = double(size.x) * size.y, finer = finePixelFactor(options_.depth);
      depths_ += kDepthBytesPerPixel * finer * whole;  // panoramas: the same for all faces together
      countDepth(photo);
      if (!options_.backdrops) continue;
      ++work_.backdrops;
      work_.backdropPixels += double(size.x) * size.y;
      const glm::ivec2 texels = depthTextureSize(size, k.width);
      made_.disk += double(textureBytes(TextureFormat::rg16f, texels.x, texels.y));
      const double completed = (isPanorama(photo) ? 1 : finer) * whole;
      completing_ = std::max(completing_, bytesToLoad(photo) + kBackdropBytesPerPixel * completed);
    }
    work_.refinements = options_.depth < DepthSearch::refined ? 0 : finePixelFactor(options_.depth);
    made_.megapixels = work_.storedPixels / 1e6;
    made_.backdrops = work_.backdrops;
  }

  void countTracks() {
    if (options_.tracks == TrackSource::model || (options_.draft && !input_.model.tracks.empty())) return;
    const auto pairs = pairsForTracks(input_.model, options_.tracks);
    work_.pairs = pairs.size();
    std::set<std::uint32_t> images;
    for (const auto& [a, b] : pairs) images.insert({a, b});
    for (const std::uint32_t i : images) {
      const Photograph& photo = input_.photographs[i];
      const double pixels = pixelsOf(matchedCamera(photo.camera).intrinsics);
      work_.featurePixels += pixels;
      features_ = std::max(features_, bytesToLoad(photo) + kFeatureBytesPerPixel * std::min(pixels, kFeaturePixels));
    }
    made_.disk += kCachedFeatureBytes * double(images.size());
  }

  // A build plans the depth of a photograph when it finds the depth; with moving objects, twice.
  void countDepthSources() {
    const bool own = input_.model.tracks.empty();
    double points = own ? kOwnObservationsPerPhotograph * double(input_.photographs.size()) : 0;
    for (const Track& track : input_.model.tracks) points += double(track.observations.size());
    double views = 0;
    for (const Photograph& photo : input_.photographs) views += double(depthViews({&photo.camera, 1}).size());
    work_.sourcePoints = points * views * (options_.maskMovingObjects ? 2 : 1);
  }

  // Faces of panoramas show surfaces beside the capture sites, so their sweeps have more levels than usual. Six faces,
  // one of each direction, stand for all.
  void countLevels() {
    constexpr std::size_t kFaces = 6;
    if (std::ranges::none_of(input_.photographs, isPanorama)) return;
    const SweepPlan plan(input_);
    std::vector<std::size_t> faces;
    for (std::size_t v = 0; v < plan.views().size(); ++v)
      if (plan.views()[v].isFace) faces.push_back(v);
    double levels = 0, pixels = 0;
    const std::size_t panoramas = faces.size() / kFaces;
    for (std::size_t k = 0; k < kFaces; ++k)
      levels += plan.levels(faces[k * panoramas / kFaces * kFaces + k]) / double(kFaces);
    for (const std::size_t v : faces) {
      const glm::ivec2 swept = sweptSize(plan.views()[v].camera.intrinsics);
      pixels += double(swept.x) * swept.y;
    }
    const double share = options_.depth == DepthSearch::fast ? kFastScale * kFastScale : 1;
    work_.extraSweptPixels = share * pixels * std::max(levels / kUsualSweepLevels - 1, 0.0);
  }

  // Without tracks the compared photographs are unknown: assumes the maximum number of comparisons.
  void countMovers() {
    const auto comparisons = comparisonPhotographs(input_);
    for (std::size_t i = 0; i < comparisons.size(); ++i) {
      const Photograph& photo = input_.photographs[i];
      if (isPanorama(photo)) continue;
      const double pixels = pixelsOf(matchedCamera(photo.camera).intrinsics);
      const glm::ivec2 swept = sweptSize(photo.camera.intrinsics);
      work_.comparedSweptPixels += kFastScale * kFastScale * swept.x * swept.y;
      work_.comparedPixels += pixels;
      work_.comparisonPixels += pixels * double(input_.model.tracks.empty() ? kMaxComparisons : comparisons[i].size());
      comparingBytes_ = std::max(comparingBytes_, bytesToCompare(photo));
      retainedBytes_ += kComparisonBytesPerPixel * pixels;
    }
  }

  // Exact poses are not refined. A model without tracks gets own tracks, which tell.
  void countRefinement() {
    const bool ownTracks = input_.model.tracks.empty() && options_.tracks != TrackSource::model;
    if (!input_.refinesPoses || (!input_.refine && !ownTracks)) return;
    work_.sweptCells = work_.cells;  // as if their depth were not known yet
    for (CellWork& cell : work_.sweptCells) cell.levels = std::max(cell.levels, kTypicalLevels);
    work_.refinementObservations = (kObservationsPerPhotograph + (ownTracks ? kOwnObservationsPerPhotograph : 0)) *
                                   double(input_.photographs.size());
    for (const Track& track : input_.model.tracks) work_.refinementObservations += double(track.observations.size());
  }

  void countCells() {
    made_.cellCountKnown = plan_ != nullptr;
    if (options_.draft) {
      made_.cellCountKnown = true;
    } else if (plan_) {
      for (const CellMembers& members : plan_->cells) work_.cells.push_back(maker_.work(members));
    } else {
      for (const Photograph& photo : input_.photographs) {
        const double pixels = pixelsOf(matchedCamera(photo.camera).intrinsics);
        work_.cells.push_back({pixels, kTypicalLevels, kTypicalMembers, double(kTypicalMembers) * photo.sourcePixels,
                               bytesToLoad(photo), pixelsOf(photo.camera.intrinsics) - pixels});
      }
    }
    made_.cells = work_.cells.size();
    for (const CellWork& cell : work_.cells) {
      retainedBytes_ += cachedCellBytes(cell);
      matching_ = std::max(matching_, bytesToMake(cell));
    }
    for (const Photograph& photo : input_.photographs) {
      const glm::ivec2 size = backdropSize(photo.camera.intrinsics);
      if (options_.backdrops) retainedBytes_ += cachedCellBytes({double(size.x) * size.y, 0, 1});
    }
    made_.disk += 2 * retainedBytes_;  // in the scene, and in the cache for the next build
  }

  void assignThreads() {
    const double held = kProgramBytes + residentMemory(), allowed = made_.memoryLimitBytes;
    double most = 0;
    const auto threads = [&](double bytesEach, double retained, std::size_t jobs) {
      const int side = std::min(threadsFor(options_.threads, bytesEach, std::max(allowed - held - retained, 1.0)),
                                int(std::max<std::size_t>(jobs, 1)));
      most = std::max(most, held + retained + side * bytesEach);
      return side;
    };
    const std::size_t photographs = input_.photographs.size();
    StageThreads side;
    side.storing = threads(storing_, 0, photographs);
    side.features = work_.pairs > 0 ? threads(features_, 0, photographs) : 1;
    if (options_.maskMovingObjects) side.movers = threads(comparingBytes_, retainedBytes_ + depths_, photographs);
    side.cells = threads(matching_, retainedBytes_ + depths_, std::max<std::size_t>(work_.cells.size(), 1));
    if (work_.exposures) threads(loading_, retainedBytes_ + depths_ + bytesToCompareExposures(work_), photographs);
    threads(reading_, retainedBytes_ + depths_, photographs);
    side.backdrops = threads(std::max(completing_, sweeping_), retainedBytes_ + depths_, photographs);
    made_.threads = side.cells;
    made_.memory = most;
    const MachineSpeed speed = measureSpeed(side.cells);
    for (const StageCost& cost : costOf(work_, side, options_.texture, speed)) {
      made_.stages.push_back({cost.stage, cost.seconds, cost.cpuSeconds});
      made_.seconds += cost.seconds;
      made_.cpuSeconds += cost.cpuSeconds;
    }
  }

  const BuildInput& input_;
  const BuildOptions& options_;
  const CellPlan* const plan_;
  const CellMaker maker_;
  BuildWork work_;
  // Peak memory of one job, bytes.
  double storing_ = 0, loading_ = 0, reading_ = 0, features_ = 0, comparingBytes_ = 0, matching_ = 0, sweeping_ = 0,
         completing_ = 0;
  double retainedBytes_ = 0;  // bytes of all meshes
  double depths_ = 0;         // bytes of all photographs' depth and evidence, and of the images that depth is found in
  BuildPrediction made_;
};

}  // namespace

BuildPrediction predictBuild(const BuildInput& input, const BuildOptions& options, const CellPlan* plan) {
  return Predictor(input, options, plan).predict();
}

BuildPrediction predictWithoutPoses(const BuildOptions& options) {
  BuildInput input;
  std::vector<std::string> faults;
  for (const std::string& name : scanPhotographFolder(options.photographs).pictures) {
    if (std::ranges::find(options.exclude, name) != options.exclude.end()) continue;
    ImageFileInfo info;
    try {
      info = probeImage(options.photographs / name);
    } catch (const Error& error) {
      if (!isFileError(error)) throw;
      faults.push_back(error.what());
      continue;
    }
    const bool turned = info.orientation >= 5;
    PosedImage image{name,
                     {pinholeFromFov(turned ? info.height : info.width, turned ? info.width : info.height, 1), {}}};
    input.photographs.push_back(findPhotograph(options.photographs, image, options.maxSize));
    input.model.images.push_back(std::move(image));
  }
  checkReadable(std::move(faults));
  checkEnoughForPoses(options.photographs, input.photographs.size());
  BuildPrediction prediction = predictBuild(input, options, nullptr);
  prediction.posesKnown = false;
  return prediction;
}

void checkDiskSpace(const BuildPrediction& prediction, const BuildOptions& options, const LogCallback& log) {
  const auto text = [](double bytes) {
    return bytes < 1e9 ? fmt::format("{:.0f} MB", bytes / 1e6) : fmt::format("{:.1f} GB", bytes / 1e9);
  };
  check(prediction.diskFreeBytes <= 0 || prediction.disk <= 1.5 * prediction.diskFreeBytes, ErrorCode::io,
        "{}: the scene needs about {} of disk space, but only {} are free. --texture bc7 stores textures in a quarter "
        "of the space, --max-size makes photographs smaller",
        options.output.string(), text(prediction.disk), text(prediction.diskFreeBytes));
  if (!log) return;
  if (prediction.diskFreeBytes > 0 && prediction.disk > prediction.diskFreeBytes)
    log(LogLevel::warning, fmt::format("disk space may not suffice: about {} are needed, {} are free",
                                       text(prediction.disk), text(prediction.diskFreeBytes)));
  if (prediction.memory > prediction.memoryLimitBytes)
    log(LogLevel::warning,
        fmt::format("up to {} of memory are needed even with one job at a time, but only {} are allowed: "
                    "--max-size makes photographs smaller, --memory allows more",
                    text(prediction.memory), text(prediction.memoryLimitBytes)));
}

}  // namespace ibr
