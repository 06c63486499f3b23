// SPDX-License-Identifier: Apache-2.0
// Builds a scene folder from posed photographs ([T] §2.4.1): model → cells → matches and meshes, cell by cell → scene.
// If a cell fails to match, its faces are tried, then their edges.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>

#include "author/build/backdrop_maker.h"
#include "author/build/build_depths.h"
#include "author/build/build_exposures.h"
#include "author/build/build_input.h"
#include "author/build/build_prediction.h"
#include "author/build/cell_maker.h"
#include "author/build/find_movers.h"
#include "author/build/own_tracks.h"
#include "author/build/pose_refinement.h"
#include "author/build/stored_photographs.h"
#include "author/depth/photograph_depth.h"
#include "author/geometry/posed_model.h"
#include "author/graph/cells.h"
#include "author/jobs/build_jobs.h"
#include "author/jobs/cached_file.h"
#include "author/match/plane_labels.h"
#include "author/photographs/border.h"
#include "author/photographs/photographs.h"
#include "base/check.h"
#include "base/file.h"
#include "base/stopwatch.h"
#include "base/usage.h"
#include "ibr/author/build.h"
#include "ibr/author/photographs.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

constexpr double kMinCoverage = 0.05;  // minimum share of the image that a cell must match

class Builder {
 public:
  Builder(const BuildOptions& options, const ProgressCallback& progress, const LogCallback& log)
      : options_(options), progress_(progress), log_(log), jobs_(options.threads, options.memory, progress) {}

  BuildReport run() {
    jobs_.step("reading the model", 0, 1);
    input_ = readInput(options_, log_);
    report_.poses = options_.model;
    const SingleThreadedOpenCv quiet;
    if (!predict()) return std::move(report_);
    scene_.nodes = storePhotographs(input_, options_, jobs_);
    const std::size_t known = input_.model.tracks.size();
    addOwnTracks(input_, options_, jobs_, log_);
    report_.masks = applyMasksToTracks(input_, log_);
    if (options_.maskMovingObjects) maskMovers();
    if (!options_.draft) {
      if (!planner_ || input_.model.tracks.size() != known || !report_.masks.empty()) planCells();
      report_.dropped = plan_.dropped;
      warnOfEmptyPlan();
    }
    describe();
    if (input_.refinesPoses) refineByCells();
    std::vector<PhotographDepth> depths = findDepths(input_, options_.depth, options_, jobs_);
    makeCells(depths);
    useDepths(std::move(depths));
    listUnused();
    if (options_.postProcess) finish();
    jobs_.step("writing the scene", 0, 1);
    saveScene(scene_, options_.output);
    if (options_.cacheFolder.empty() && !options_.draft) removeCachedBefore(buildCacheFolder(options_), startTime_);
    return std::move(report_);
  }

  RefinedModel runForPoses() {
    jobs_.step("reading the model", 0, 1);
    input_ = readInput(options_, log_);
    const SingleThreadedOpenCv quiet;
    hashPhotographs(input_, options_, jobs_);
    addOwnTracks(input_, options_, jobs_, log_);
    report_.masks = applyMasksToTracks(input_, log_);
    if (input_.refine) {
      planCells();
      makeCells({});
      refine();
    }
    if (options_.cacheFolder.empty()) removeCached(buildCacheFolder(options_));
    return {std::move(input_.model), std::move(report_.refinement)};
  }

 private:
  // Returns false if the caller cancels the build.
  bool predict() {
    if (!options_.onPrediction) return true;
    const bool found = options_.tracks == TrackSource::own || input_.model.tracks.empty();  // found later, for pinholes
    if (!options_.draft && (!found || std::ranges::all_of(input_.photographs, isPanorama))) planCells();
    report_.prediction = predictBuild(input_, options_, planner_ ? &plan_ : nullptr);
    const bool wanted = options_.onPrediction(report_.prediction);
    checkDiskSpace(report_.prediction, options_, log_);
    return wanted;
  }

  void refine() {
    jobs_.step("refining poses", 0, 1);
    report_.refinement = refinePoses(input_, scene_.cells);
  }

  // Refines poses by swept cells, which search all depths. These cells are dropped afterwards.
  void refineByCells() {
    const fs::path folder = options_.output / ".refined";
    std::error_code ignored;
    if (!fs::equivalent(folder, options_.model, ignored)) fs::remove_all(folder, ignored);  // of an earlier build
    if (!input_.refine) return;
    makeCells({});
    refine();
    if (!report_.refinement.poseChanges.empty()) {
      writeColmapModel(input_.model, folder);
      for (std::size_t n = 0; n < scene_.nodes.size(); ++n) scene_.nodes[n].camera = input_.photographs[n].camera;
      planCells();
    }
    scene_.cells.clear();
    failure_.clear();
    report_.cells.clear();
    report_.dropped = plan_.dropped;
  }

  // Finds moving objects with fast depth. Depth is found again later, because the masks change it.
  void maskMovers() {
    const std::vector<BitMask> moved =
        findMovers(input_, findDepths(input_, DepthSearch::fast, options_, jobs_), jobs_);
    if (std::ranges::all_of(moved, &BitMask::empty)) return;
    addMasks(input_, scene_.nodes, moved, options_, jobs_);
    std::map<std::string, double> given;
    for (const BuildReport::MaskReport& line : report_.masks) given[line.photograph] = line.givenShare;
    report_.masks = applyMasksToTracks(input_, log_);
    for (BuildReport::MaskReport& line : report_.masks) {
      line.movingShare = line.givenShare - given[line.photograph];
      line.givenShare -= line.movingShare;
    }
  }

  void describe() {
    const bool panoramic = std::ranges::all_of(input_.photographs, isPanorama);
    scene_.acquisition = panoramic ? "panoramic" : plan_.ordered ? "ordered" : "unordered";
    scene_.settings = nlohmann::ordered_json{
        {"dimension", options_.dimension},
        {"maxSize", options_.maxSize},
        {"texture", textureFormatName(options_.texture)},
        {"thetaDegrees", options_.thetaDegrees},
        {"seed", options_.seed},
        {"refine", input_.refine},
        {"backdrops", options_.backdrops},
        {"depth", depthSearchName(options_.depth)},
        {"backdropSpacing", options_.backdropSpacing},
        {"tracks", trackSourceName(options_.tracks)},
        {"keepBorder", options_.keepBorder},
        {"matcher", matchMethodName(options_.matcher)},
        {"triangleFilter", options_.triangleFilter == TriangleFilter::consistency ? "consistency" : "homogeneous"},
        {"matchExposures", options_.matchExposures},
        {"vignetting", options_.fitVignetting},
        {"refinePoses", input_.refinesPoses},
        {"removeMovers", options_.maskMovingObjects},
        {"draft",
         options_.draft}}.dump();
  }

  void planCells() {
    planner_.emplace(input_.model, options_);
    plan_ = planner_->plan();
  }

  void warnOfEmptyPlan() const {
    if (!log_ || !plan_.cells.empty() || input_.photographs.size() < 2) return;
    const bool shared =
        std::ranges::any_of(input_.model.tracks, [](const Track& t) { return t.observations.size() > 1; });
    const std::string text =
        fmt::format("none of the {} photographs can be joined into a cell: {}", input_.photographs.size(),
                    shared ? "the report lists the reasons"
                           : "no point of the model is seen by two of them; check that points3D has its tracks");
    log_(LogLevel::warning, text);
  }

  // `depths`: of the photographs, from which the cells take theirs; empty: the cells are swept.
  void makeCells(std::span<const PhotographDepth> depths) {
    const CellMaker maker(input_, options_, depths.empty() ? MemberDepths() : memberDepths(depths));
    std::vector<CellMembers> wanted = plan_.cells, done;
    for (std::string_view stage = "matching cells"; !wanted.empty(); stage = "matching replacement cells") {
      std::vector<CellResult> made(wanted.size());
      double retained = 0, most = 0;
      for (const CellMembers& members : wanted) {
        const CellWork work = maker.work(members);
        retained += cachedCellBytes(work) / double(wanted.size());
        most = std::max(most, bytesToMake(work));
      }
      jobs_.runAll(
          stage, wanted.size(), most, [&](std::size_t c) { made[c] = maker.make(wanted[c]); }, retained);
      std::vector<CellMembers> failed;
      for (std::size_t c = 0; c < wanted.size(); ++c)
        (take(wanted[c], std::move(made[c])) ? done : failed).push_back(wanted[c]);
      wanted = planner_->replacementFaces(failed, done);
    }
  }

  std::vector<std::string> namesOf(const CellMembers& members) const {
    std::vector<std::string> names;
    for (const std::uint32_t i : members) names.push_back(input_.photographs[i].name);
    return names;
  }

  BorderCut cutBorder(Cell& cell) const {
    if (!options_.keepBorder) return {};
    std::vector<const Photograph*> members;
    for (const std::uint32_t i : cell.members) members.push_back(&input_.photographs[i]);
    return dropBorder(cell.mesh, members);
  }

  // Adds the cell to the scene if its quality suffices.
  bool take(const CellMembers& members, CellResult made) {
    Cell cell{members, std::move(made.cell.mesh), made.cell.quality};
    CellQuality& quality = cell.quality;
    if (const BorderCut cut = cutBorder(cell); cut.left != 1) {
      quality.coverage *= cut.left;
      quality.ecc = cut.ecc;
    }
    if (!(quality.coverage >= kMinCoverage)) {
      const std::string names = fmt::format("{}", fmt::join(namesOf(members), ", "));
      const std::string reason = fmt::format("its members agree on {:.1f} % of their pixels, less than {:.0f} %",
                                             100 * quality.coverage, 100 * kMinCoverage);
      report_.dropped.push_back({names, reason});
      for (const std::uint32_t i : members) failure_[i] = fmt::format("{}: {}", names, reason);
      return false;
    }
    quality.score = planner_->score(members) * quality.coverage * std::max(quality.ecc, 0.0);
    report_.cells.push_back({namesOf(members), cell.mesh.vertexCount(), cell.mesh.triangles.size(),
                             cell.mesh.tier0Count(), quality, made.seconds, made.cpuSeconds, made.cached, made.matcher,
                             homogeneousShare(cell.mesh)});
    scene_.cells.push_back(std::move(cell));
    return true;
  }

  void listUnused() {
    std::vector<bool> used(input_.photographs.size(), false);
    for (const Cell& cell : scene_.cells)
      for (const std::uint32_t i : cell.members) used[i] = true;
    for (std::uint32_t i = 0; i < used.size(); ++i) {
      if (used[i] || options_.draft) continue;
      const auto failure = failure_.find(i);
      scene_.unusedPhotographs.push_back(
          {input_.photographs[i].name, failure != failure_.end() ? failure->second : planner_->whyUnused(i)});
    }
    scene_.unusedPhotographs.insert(scene_.unusedPhotographs.end(), input_.unknown.begin(), input_.unknown.end());
    report_.unusedPhotographs = scene_.unusedPhotographs;
  }

  // Takes the depth maps by value, so that their memory is freed at the end.
  void useDepths(std::vector<PhotographDepth> depths) {
    if (!options_.backdrops && !options_.matchExposures && !options_.fitVignetting) return;
    const BackdropMaker maker(input_, options_, scene_);
    report_.exposures = measureExposures(input_, scene_.nodes, depths, options_, jobs_);
    if (options_.backdrops) makeBackdrops(maker, depths);
  }

  void makeBackdrops(const BackdropMaker& maker, const std::vector<PhotographDepth>& depths) {
    std::vector<BackdropResult> made(depths.size());
    jobs_.runAll("completing backdrops", made.size(), maker.bytes(),
                 [&](std::size_t b) { made[b] = maker.make(std::uint32_t(b), depths[b]); });
    for (std::uint32_t b = 0; b < made.size(); ++b) {
      Node& node = scene_.nodes[b];
      node.depthFile = made[b].depthFile;
      node.depthScale = made[b].depthScale;
      CellResult& making = made[b].made;
      Cell backdrop{{b}, std::move(making.cell.mesh), making.cell.quality};
      cutBorder(backdrop);  // the share of matched depth is unchanged: the border had none
      const MorphMesh& mesh = backdrop.mesh;
      report_.backdrops.push_back({input_.photographs[b].name, mesh.vertexCount(), mesh.triangles.size(),
                                   backdrop.quality.coverage, making.seconds, making.cached});
      scene_.backdrops.push_back(std::move(backdrop));
    }
  }

  void finish() {
    scene_.folder = options_.output;
    options_.postProcess(scene_, buildCacheFolder(options_), progress_, log_);
    for (std::size_t c = 0; c < scene_.cells.size(); ++c) report_.cells[c].quality = scene_.cells[c].quality;
  }

  const BuildOptions& options_;
  const ProgressCallback& progress_;
  const LogCallback& log_;
  const BuildJobs jobs_;
  const fs::file_time_type startTime_ = fs::file_time_type::clock::now();
  BuildInput input_;
  std::optional<CellPlanner> planner_;
  CellPlan plan_;
  std::map<std::uint32_t, std::string> failure_;  // of photographs whose cells failed: the last cell's message
  BuildReport report_;
  Scene scene_;
};

// Adds estimated poses to options without poses.
BuildOptions posed(BuildOptions options, const ProgressCallback& progress, const LogCallback& log) {
  if (!options.model.empty()) return options;
  options.model = estimatePoses({.photographs = options.photographs,
                                 .folder = options.output / ".poses",
                                 .program = options.colmap,
                                 .threads = options.threads,
                                 .excludedFolder = options.output / "images",
                                 .exclude = options.exclude,
                                 .orientation = options.orientation,
                                 .masks = options.masks},
                                progress, log)
                      .model;
  if (options.orientation == Orientation::automatic) options.orientation = Orientation::exif;  // of the estimated poses
  return options;
}

// Options of a draft: skips what a preview does not need, and uses fast depth.
BuildOptions draftOptions(BuildOptions options) {
  check(options.backdrops, ErrorCode::invalidInput, "a draft needs backdrops, because it has no cells");
  options.depth = DepthSearch::fast;
  options.refinePoses = RefinePoses::off;
  options.maskMovingObjects = options.fitVignetting = false;
  options.postProcess = nullptr;
  return options;
}

}  // namespace

BuildReport build(const BuildOptions& requested, const ProgressCallback& progress, const LogCallback& log) {
  const Stopwatch watch;
  checkOptions(requested);
  checkOutputFolder(requested);
  const BuildOptions options = requested.draft ? draftOptions(requested) : requested;
  if (log) {
    const PhotographFolder folder = scanPhotographFolder(options.photographs);
    if (!folder.unreadable.empty()) log(LogLevel::warning, unreadableText(folder.unreadable));
    log(LogLevel::info, fmt::format("{}: {}", options.photographs.string(), countText(folder)));
  }
  const double before = cpuSeconds();
  if (options.model.empty() && options.onPrediction) {
    const SingleThreadedOpenCv quiet;
    BuildReport cancelled;
    cancelled.prediction = predictWithoutPoses(options);
    if (!options.onPrediction(cancelled.prediction)) return cancelled;
  }
  const BuildOptions known = posed(options, progress, log);
  BuildReport report = Builder(known, progress, log).run();
  report.seconds = watch.seconds();
  report.cpuSeconds = cpuSeconds() - before;
  report.memory = peakMemory();
  return report;
}

RefinedModel refineModelPoses(const BuildOptions& options, const ProgressCallback& progress, const LogCallback& log) {
  checkOptions(options);
  const BuildOptions known = posed(options, progress, log);
  return Builder(known, progress, log).runForPoses();
}

}  // namespace ibr
