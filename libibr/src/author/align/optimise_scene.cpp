// SPDX-License-Identifier: Apache-2.0
#include "ibr/author/optimise_scene.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <nlohmann/json.hpp>
#include <numeric>

#include "author/align/aligned_cache.h"
#include "author/jobs/cached_file.h"
#include "author/photographs/masks.h"
#include "base/check.h"
#include "base/file.h"
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "ibr/scene.h"
#include "io/image_file.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

constexpr double kBytesPerPixel = 40;  // memory of a cell, per pixel of all its members
constexpr double kTypicalCycles = 3;   // after this number of cycles, half of a cell counts as done
constexpr const char* kStage = "optimising cells";

bool runsOnCpu(AlignmentMethod method) {
  return method == AlignmentMethod::cpu || method == AlignmentMethod::gradient;
}

const char* nameOf(AlignmentMethod method) {
  constexpr const char* kNames[] = {"raster", "compute", "cpu", "gradient"};
  return kNames[std::size_t(method)];
}

class Optimiser {
 public:
  Optimiser(const Scene& scene, const OptimiseCellsOptions& options, const Aligner& aligner,
            const ProgressCallback& progress)
      : scene_(scene), options_(options), aligner_(aligner), progress_(progress), cells_(options.cells) {
    std::ranges::sort(cells_);
    for (std::size_t k = 0; k < cells_.size(); ++k) {
      check(cells_[k] < scene.cells.size(), ErrorCode::invalidInput, "no cell {}: the scene has {} cells", cells_[k],
            scene.cells.size());
      check(k == 0 || cells_[k] != cells_[k - 1], ErrorCode::invalidInput, "cell {} is listed twice", cells_[k]);
    }
    if (cells_.empty()) {
      cells_.resize(scene.cells.size());
      std::iota(cells_.begin(), cells_.end(), std::size_t(0));
    }
    const std::size_t count = cells_.size();
    shareDone_ = std::vector<std::atomic<double>>(count);
    for (const std::size_t c : cells_)
      work_.push_back(scene.cells[c].mesh.vertexCount() * scene.cells[c].members.size());
  }

  std::vector<AlignedCell> run() {
    const bool sideBySide = runsOnCpu(options_.alignment.method);
    const int threads = threadsFor(options_.threads, 1), jobs = sideBySide ? threadsFor(threads, bytes()) : 1;
    const int together = std::max(1, std::min(jobs, int(cells_.size())));
    threadsPerCell_ = sideBySide ? std::max(1, threads / together) : threads;
    std::vector<AlignedCell> done(cells_.size());
    const bool finished = runJobs(
        cells_.size(), together, [&](std::size_t k) { done[k] = aligned(k); },
        [&](std::size_t) { return reportProgress(); });
    check(finished, ErrorCode::cancelled, "cancelled while {}; the next run continues from there", kStage);
    return done;
  }

 private:
  bool reportProgress() {
    const std::size_t total = std::accumulate(work_.begin(), work_.end(), std::size_t(0));
    double done = 0;
    for (std::size_t k = 0; k < cells_.size(); ++k) done += shareDone_[k].load() * double(work_[k]);
    if (progress_ && !progress_({kStage, std::min(std::size_t(done), total), total})) cancelled_ = true;
    return !cancelled_;
  }

  AlignedCell aligned(std::size_t k) {
    const Stopwatch watch;
    const Cell& cell = scene_.cells[cells_[k]];
    std::vector<MatchView> views;
    for (const std::uint32_t i : cell.members) {
      const Node& node = scene_.nodes[i];
      views.push_back({node.camera, readImage(pathInside(scene_.folder, node.imageFile))});
      const Intrinsics& camera = node.camera.intrinsics;
      check(views.back().picture.width == camera.width && views.back().picture.height == camera.height,
            ErrorCode::invalidInput, "{}: the image is not {} × {} px, the size of its camera", node.imageFile.string(),
            camera.width, camera.height);
      if (!node.maskFile.empty()) views.back().mask = readMask(pathInside(scene_.folder, node.maskFile), camera);
    }
    const CellAlignmentInput input{views, cell};
    const bool keeps = !options_.cacheFolder.empty();
    const std::uint64_t key = keeps ? alignmentKey(input, options_.alignment) : 0;
    std::optional<AlignedCell> kept;
    if (keeps) kept = fetchAligned(options_.cacheFolder, key);
    AlignedCell done = kept ? std::move(*kept) : alignCell(input, cellOptions(), aligner_, [&](const Progress& p) {
      // The number of cycles is unknown in advance; about five is typical.
      shareDone_[k] = double(p.done) / (p.total > 0 ? double(p.total) : double(p.done) + kTypicalCycles);
      return !cancelled_.load();
    });
    if (!kept && keeps) storeAligned(options_.cacheFolder, key, done);
    OptimisedCell& facts = done.facts;
    facts.cached = kept.has_value();
    facts.cell = cells_[k];
    for (const std::uint32_t i : cell.members) facts.members.push_back(scene_.nodes[i].name);
    facts.width = views[0].picture.width;
    facts.height = views[0].picture.height;
    facts.seconds = watch.seconds();
    shareDone_[k] = 1;
    return done;
  }

  AlignmentOptions cellOptions() const {
    AlignmentOptions each = options_.alignment;
    each.threads = threadsPerCell_;
    return each;
  }

  double bytes() const {
    double most = 0;
    for (const std::size_t c : cells_) {
      double pixels = 0;
      for (const std::uint32_t i : scene_.cells[c].members)
        pixels += double(scene_.nodes[i].camera.intrinsics.width) * scene_.nodes[i].camera.intrinsics.height;
      most = std::max(most, kBytesPerPixel * pixels);
    }
    return most;
  }

  const Scene& scene_;
  const OptimiseCellsOptions& options_;
  const Aligner& aligner_;
  const ProgressCallback& progress_;
  std::vector<std::size_t> cells_;  // ascending
  std::vector<std::size_t> work_;   // of each cell: points times images
  std::vector<std::atomic<double>> shareDone_;
  std::atomic<bool> cancelled_ = false;
  int threadsPerCell_ = 1;
};

// Records in the scene's settings how its cells were optimised.
std::string settingsWith(const std::string& settings, const OptimiseCellsOptions& options) {
  using Json = nlohmann::ordered_json;
  Json json = Json::parse(settings, nullptr, false);
  if (!json.is_object()) json = Json::object();
  const AlignmentOptions& a = options.alignment;
  json["optimised"] = {{"method", nameOf(a.method)},
                       {"definition", a.definition == EccDefinition::channels ? "channels" : "concatenated"},
                       {"instances", a.instances},
                       {"radius", a.radiusPx},
                       {"decay", a.decay},
                       {"threshold", a.threshold},
                       {"rigidity", a.rigidity},
                       {"epipolar", a.epipolarWeight},
                       {"levels", a.levels},
                       {"escape", a.escape},
                       {"flipEdges", a.flipEdges},
                       {"flipGain", a.flipGain},
                       {"insertPoints", a.insertPoints},
                       {"insertBelow", a.insertBelow},
                       {"insertGain", a.insertGain},
                       {"insertShare", a.insertShare},
                       {"prune", a.prune},
                       {"seed", a.seed}};
  if (!options.cells.empty()) json["optimised"]["cells"] = options.cells;
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

OptimiseSceneReport optimiseCells(Scene& scene, const OptimiseCellsOptions& options, const Aligner& aligner,
                                  const ProgressCallback& progress, const LogCallback& log) {
  const Stopwatch watch;
  check(options.threads >= 0, ErrorCode::invalidInput, "threads is {}, must be 0 or more", options.threads);
  if (!options.cacheFolder.empty()) makeFolders(options.cacheFolder);
  std::vector<AlignedCell> done = Optimiser(scene, options, aligner, progress).run();
  OptimiseSceneReport report;
  std::size_t reverted = 0, judged = 0;
  double before = 0, after = 0;
  for (AlignedCell& cell : done) {
    Cell& now = scene.cells[cell.facts.cell];
    now.mesh = std::move(cell.mesh);
    now.mesh.confirmations.clear();  // lists belong to the old positions
    now.mesh.consensus.clear();
    now.quality = cell.quality;
    reverted += cell.facts.reverted;
    if (cell.facts.evaluated > 0) {
      ++judged;
      before += cell.facts.summary.initialEcc;
      after += cell.facts.summary.finalEcc;
    }
    report.cells.push_back(std::move(cell.facts));
  }
  scene.settings = settingsWith(scene.settings, options);
  if (log && judged > 0)
    log(LogLevel::info, fmt::format("mean ECC of {} cells: {:.3f} before and {:.3f} after optimisation", judged,
                                    before / double(judged), after / double(judged)));
  if (log && reverted > 0)
    log(LogLevel::debug, fmt::format("{} points moved back, because their triangles would have flipped", reverted));
  report.seconds = watch.seconds();
  return report;
}

OptimiseSceneReport optimiseScene(const OptimiseSceneOptions& options, const Aligner& aligner,
                                  const ProgressCallback& progress, const LogCallback& log) {
  const Stopwatch watch;
  check(!options.output.empty(), ErrorCode::invalidInput, "the output folder of the scene is not set");
  Scene scene = loadScene(options.scene);
  std::error_code ignored;
  check(!fs::equivalent(scene.folder, options.output, ignored), ErrorCode::invalidInput,
        "{}: the output would overwrite the source scene; choose another folder", options.output.string());
  OptimiseCellsOptions cells = options.cells;
  if (cells.cacheFolder.empty()) cells.cacheFolder = options.output / ".optimise";
  OptimiseSceneReport report = optimiseCells(scene, cells, aligner, progress, log);
  saveSceneWithLinks(scene, options.output);
  if (options.cells.cacheFolder.empty()) removeCached(cells.cacheFolder);
  report.seconds = watch.seconds();
  return report;
}

}  // namespace ibr
