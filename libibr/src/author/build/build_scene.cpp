// SPDX-License-Identifier: Apache-2.0
// Builds a scene folder from posed photographs ([T] §2.4.1): model → cells → matches and meshes, cell by cell → scene.
// If a cell fails to match, its faces are tried, then their edges.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>

#include "author/backdrop/backdrop.h"
#include "author/build/backdrop_maker.h"
#include "author/build/build_input.h"
#include "author/build/build_prediction.h"
#include "author/build/cell_maker.h"
#include "author/build/depth_matcher.h"
#include "author/build/find_movers.h"
#include "author/build/own_tracks.h"
#include "author/build/pose_rounds.h"
#include "author/depth/photograph_depth.h"
#include "author/exposure/exposure.h"
#include "author/exposure/vignetting.h"
#include "author/geometry/posed_model.h"
#include "author/graph/cells.h"
#include "author/jobs/build_jobs.h"
#include "author/jobs/kept_file.h"
#include "author/match/plane_labels.h"
#include "author/photographs/border.h"
#include "author/photographs/masks.h"
#include "author/photographs/photographs.h"
#include "base/check.h"
#include "base/file.h"
#include "base/stopwatch.h"
#include "base/usage.h"
#include "ibr/author/build.h"
#include "ibr/author/photographs.h"
#include "io/image_file.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

constexpr double kLeastCoverage = 0.05;  // min share of the image that a cell must match
constexpr double kHardlyUsed = 0.9;      // masked share of a photograph above which the mask may be inverted

class Builder {
 public:
  Builder(const BuildOptions& options, const ProgressCallback& progress, const LogCallback& log)
      : options_(options), progress_(progress), log_(log), jobs_(options.threads, options.memory, progress) {}

  BuildReport run() {
    jobs_.step("reading the model", 0, 1);
    input_ = readInput(options_, log_);
    report_.poses = posesFile(options_);
    const SingleThreadedOpenCv quiet;
    if (!predict()) return std::move(report_);
    storePhotographs();
    const std::size_t known = input_.model.tracks.size();
    addOwnTracks(input_, options_, jobs_, log_);
    takeMasksFromTracks();
    if (options_.removeMovers) maskMovers();
    if (!options_.draft) {
      if (!planner_ || input_.model.tracks.size() != known || !report_.masks.empty()) planCells();
      report_.dropped = plan_.dropped;
      warnOfEmptyPlan();
    }
    describe();
    if (options_.refinePoses) refineByCells();
    std::vector<PhotographDepth> depths = findDepths(options_.depth);
    makeCells(depths);
    useDepths(std::move(depths));
    listUnused();
    if (options_.postProcess) finish();
    jobs_.step("writing the scene", 0, 1);
    saveScene(scene_, options_.output);
    if (options_.cacheFolder.empty() && !options_.draft) removeKeptBefore(keptFolder(options_), begun_);
    return std::move(report_);
  }

  RefinedModel runForPoses() {
    jobs_.step("reading the model", 0, 1);
    input_ = readInput(options_, log_);
    const SingleThreadedOpenCv quiet;
    hashPhotographs();
    addOwnTracks(input_, options_, jobs_, log_);
    takeMasksFromTracks();
    if (input_.refine) {
      planCells();
      makeCells({});
      refine();
    }
    if (options_.cacheFolder.empty()) removeKept(keptFolder(options_));
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
    checkRoom(report_.prediction, options_, log_);
    return wanted;
  }

  // Hashes the photographs and stores their masks at the stored size in the cache: no scene folder exists yet.
  void hashPhotographs() {
    makeFolders(keptFolder(options_));
    input_.hashes.resize(input_.photographs.size());
    double bytes = 0;
    for (const Photograph& photo : input_.photographs) bytes = std::max(bytes, photo.sourcePixels + bytesToLoad(photo));
    jobs_.runAll("reading photographs", input_.photographs.size(), bytes, [&](std::size_t i) {
      Photograph& photo = input_.photographs[i];
      input_.hashes[i] = hashPhotograph(photo);
      if (photo.mask.empty()) return;
      photo.storedMask = keptFile(keptFolder(options_), input_.hashes[i], "png");
      writeImage(photo.storedMask, loadMask(photo, photo.mask));
    });
  }

  void storePhotographs() {
    makeFolders(keptFolder(options_));
    input_.hashes.resize(input_.photographs.size());
    double bytes = 0;
    for (const Photograph& photo : input_.photographs) bytes = std::max(bytes, bytesToStore(photo));
    std::vector<std::string> faults(input_.photographs.size());  // all are reported at once
    jobs_.runAll("storing photographs", input_.photographs.size(), bytes, [&](std::size_t i) {
      try {
        input_.hashes[i] = storePhotograph(input_.photographs[i], options_.output, options_.texture);
      } catch (const Error& error) {
        if (!isOfFile(error)) throw;
        faults[i] = error.what();
      }
    });
    checkReadable(std::move(faults));
    for (const Photograph& photo : input_.photographs)
      scene_.nodes.push_back({photo.name, photo.camera, photo.imageFile, photo.textureFile, photo.capture});
    for (std::size_t n = 0; n < scene_.nodes.size(); ++n)
      if (const Photograph& photo = input_.photographs[n]; !photo.storedMask.empty())
        scene_.nodes[n].maskFile = storedMaskFile(photo.name);
  }

  void takeMasksFromTracks() {
    report_.masks.clear();
    for (std::uint32_t i = 0; i < input_.photographs.size(); ++i) {  // one mask is held at a time
      const Image8 mask = storedMask(input_.photographs[i]);
      const double share = ignoredShare(mask);
      if (share > 0) report_.masks.push_back({input_.photographs[i].name, share, 0});
      if (share > kHardlyUsed && log_)
        log_(
            LogLevel::warning,
            fmt::format("{}: the mask leaves {:.0f} % of the photograph. Pixels of value 0 are ignored, all others are "
                        "used; check that the mask is not inverted",
                        input_.photographs[i].name, 100 * (1 - share)));
      dropIgnored(input_.model, i, input_.tracksOf[i], mask);
    }
    if (report_.masks.empty()) return;
    dropUnseen(input_.model);
    input_.tracksOf = tracksOfImages(input_.model);
  }

  void refine() {
    jobs_.step("refining poses", 0, 1);
    report_.refinement = refinePoses(input_, scene_.cells);
  }

  // Refines poses by swept cells, which search all depths. These cells are dropped afterwards.
  void refineByCells() {
    const fs::path folder = options_.output / ".refined";
    std::error_code ignored;
    if (!fs::equivalent(folder, posesFile(options_), ignored)) fs::remove_all(folder, ignored);  // of an earlier build
    if (!input_.refine) return;
    makeCells({});
    refine();
    if (!report_.refinement.moved.empty()) {
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
    const std::vector<BitMask> moved = findMovers(input_, findDepths(DepthSearch::fast), jobs_);
    if (std::ranges::all_of(moved, &BitMask::empty)) return;
    double bytes = 0;
    for (const Photograph& photo : input_.photographs) bytes = std::max(bytes, bytesToStore(photo));
    jobs_.runAll("masking moving objects", moved.size(), bytes, [&](std::size_t i) {
      if (!moved[i].empty()) addMask(i, moved[i]);
    });
    std::map<std::string, double> given;
    for (const BuildReport::MaskLine& line : report_.masks) given[line.photograph] = line.given;
    takeMasksFromTracks();
    for (BuildReport::MaskLine& line : report_.masks) {
      line.moved = line.given - given[line.photograph];
      line.given -= line.moved;
    }
  }

  // Adds `moved` to the photograph's mask, if any, and updates its hash.
  void addMask(std::size_t i, const BitMask& moved) {
    Photograph& photo = input_.photographs[i];
    Image8 mask = maskOf(moved, photo.camera.intrinsics.width, photo.camera.intrinsics.height);
    if (!photo.storedMask.empty()) mask = bothMasks(mask, storedMask(photo));
    Hash hash;
    hash.add(input_.hashes[i]);
    hash.add(storeMask(photo, mask, loadPhotograph(photo), options_.output, options_.texture));
    input_.hashes[i] = hash.value();
    scene_.nodes[i].maskFile = storedMaskFile(photo.name);
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
        {"matcher", methodName(options_.matcher)},
        {"triangleFilter", options_.triangleFilter == TriangleFilter::consistency ? "consistency" : "homogeneous"},
        {"matchExposures", options_.matchExposures},
        {"vignetting", options_.fitVignetting},
        {"refinePoses", options_.refinePoses},
        {"removeMovers", options_.removeMovers},
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
    const CellMaker maker(input_, options_, depths);
    std::vector<CellMembers> wanted = plan_.cells, done;
    for (std::string_view stage = "matching cells"; !wanted.empty(); stage = "matching replacement cells") {
      std::vector<MadeCell> made(wanted.size());
      double kept = 0, most = 0;
      for (const CellMembers& members : wanted) {
        const CellWork work = maker.work(members);
        kept += bytesKept(work) / double(wanted.size());
        most = std::max(most, bytesToMake(work));
      }
      jobs_.runAll(
          stage, wanted.size(), most, [&](std::size_t c) { made[c] = maker.make(wanted[c]); }, kept);
      std::vector<CellMembers> failed;
      for (std::size_t c = 0; c < wanted.size(); ++c)
        (take(wanted[c], std::move(made[c])) ? done : failed).push_back(wanted[c]);
      wanted = planner_->standIns(failed, done);
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
  bool take(const CellMembers& members, MadeCell made) {
    Cell cell{members, std::move(made.cell.mesh), made.cell.quality};
    CellQuality& quality = cell.quality;
    if (const BorderCut cut = cutBorder(cell); cut.left != 1) {
      quality.coverage *= cut.left;
      quality.ecc = cut.ecc;
    }
    if (!(quality.coverage >= kLeastCoverage)) {
      const std::string names = fmt::format("{}", fmt::join(namesOf(members), ", "));
      const std::string reason = fmt::format("its members agree on {:.1f} % of their pixels, less than {:.0f} %",
                                             100 * quality.coverage, 100 * kLeastCoverage);
      report_.dropped.push_back({names, reason});
      for (const std::uint32_t i : members) failure_[i] = fmt::format("{}: {}", names, reason);
      return false;
    }
    quality.score = planner_->score(members) * quality.coverage * std::max(quality.ecc, 0.0);
    report_.cells.push_back({namesOf(members), cell.mesh.pointCount(), cell.mesh.triangles.size(),
                             cell.mesh.tier0Count(), quality, made.seconds, made.processorSeconds, made.resumed,
                             made.matcher, homogeneousShare(cell.mesh)});
    scene_.cells.push_back(std::move(cell));
    return true;
  }

  void takeExposures(const std::vector<PhotographDepth>& depths) {
    if (!options_.matchExposures && !options_.fitVignetting) return;
    std::vector<ExposureMatch> matches = exposureMatches(input_.photographs, input_.model, depths, jobs_);
    if (options_.fitVignetting) takeVignetting(matches);
    if (!options_.matchExposures) return;
    std::vector<CaptureFacts> exif;
    for (const Photograph& photo : input_.photographs) exif.push_back(photo.capture);
    jobs_.step("solving exposures", 0, 1);
    const Exposures exposures = solveExposures(input_.photographs.size(), matches, exif);
    for (std::size_t n = 0; n < exposures.gains.size(); ++n) scene_.nodes[n].gain = exposures.gains[n];
    report_.exposures.measured = exposures.measured;
    report_.exposures.parts = exposures.parts;
    report_.exposures.alike = exposures.alike;
    report_.exposures.text = describedExposures(exposures);
  }

  // Fits vignetting to `matches` and removes it from the stored photographs.
  void takeVignetting(std::vector<ExposureMatch>& matches) {
    const std::vector<std::uint32_t> lenses = lensesOf(input_.photographs);
    const std::vector<glm::dvec2> vignetting = solveVignetting(input_.photographs.size(), matches, lenses);
    double bytes = 0;
    for (const Photograph& photo : input_.photographs) bytes = std::max(bytes, bytesToStore(photo));
    jobs_.runAll("removing vignetting", vignetting.size(), bytes, [&](std::size_t n) {
      if (isNegligible(vignetting[n])) return;
      Photograph& photo = input_.photographs[n];
      storeInstead(photo, unvignetted(loadPhotograph(photo), photo.camera.intrinsics, vignetting[n]), options_.output,
                   options_.texture);
    });
    matches = withoutVignetting(std::move(matches), vignetting);
    report_.exposures.vignetting = describedVignetting(vignetting, lenses);
  }

  void listUnused() {
    std::vector<bool> used(input_.photographs.size(), false);
    for (const Cell& cell : scene_.cells)
      for (const std::uint32_t i : cell.members) used[i] = true;
    for (std::uint32_t i = 0; i < used.size(); ++i) {
      if (used[i] || options_.draft) continue;
      const auto failure = failure_.find(i);
      scene_.unused.push_back(
          {input_.photographs[i].name, failure != failure_.end() ? failure->second : planner_->whyUnused(i)});
    }
    scene_.unused.insert(scene_.unused.end(), input_.unknown.begin(), input_.unknown.end());
    report_.unused = scene_.unused;
  }

  // Takes the depth maps by value, so that their memory is freed at the end.
  void useDepths(std::vector<PhotographDepth> depths) {
    if (!options_.backdrops && !options_.matchExposures && !options_.fitVignetting) return;
    const BackdropMaker maker(input_, options_, scene_);
    takeExposures(depths);
    if (options_.backdrops) makeBackdrops(maker, depths);
  }

  // Depth maps in the order of the photographs.
  std::vector<PhotographDepth> findDepths(DepthSearch search) const {
    constexpr double kFaceShare = 0.5;  // share of a panorama's pixels: one face and its part of the whole
    double pixels = 0;
    for (const Photograph& photo : input_.photographs) {
      const glm::ivec2 size = backdropSize(photo.camera.intrinsics);
      pixels = std::max(pixels, (isPanorama(photo) ? kFaceShare : 1) * finerPixels(search) * size.x * size.y);
    }
    const DepthMatcher matcher(input_, search, keptFolder(options_), jobs_);
    std::size_t run = 0;
    std::vector<Camera> cameras;
    for (const Photograph& photo : input_.photographs) cameras.push_back(photo.camera);
    return depthOfPhotographs(
        cameras,
        {.matches = [&](std::size_t view) { return matcher.match(view); },
         .points = [&](std::uint32_t photograph) { return pointsSeenBy(input_, photograph); },
         .residualPx = storedResidualPx(),
         .depths =
             [&](std::size_t count, const auto& job) {
               jobs_.runAll("finding depth", count, matcher.bytesToMatch(), job, kDepthBytesPerPixel * pixels);
             },
         .evidence =
             [&](std::size_t count, const auto& job) {
               constexpr std::array kStages{"choosing depth sources", "confirming depth", "finding contradictions"};
               static_assert(kStages.size() == kEvidenceRuns);
               jobs_.runAll(kStages[run++], count, 1, job);
             }});
  }

  // Reprojection error of the model's points, px of the stored photographs.
  double storedResidualPx() const {
    if (input_.photographs.empty()) return 0;
    const double scale =
        double(input_.photographs[0].camera.intrinsics.width) / double(input_.model.images[0].camera.intrinsics.width);
    return scale * reprojectionError(input_.model);
  }

  void makeBackdrops(const BackdropMaker& maker, const std::vector<PhotographDepth>& depths) {
    std::vector<MadeBackdrop> made(depths.size());
    jobs_.runAll("completing backdrops", made.size(), maker.bytes(),
                 [&](std::size_t b) { made[b] = maker.make(std::uint32_t(b), depths[b]); });
    for (std::uint32_t b = 0; b < made.size(); ++b) {
      Node& node = scene_.nodes[b];
      node.depthFile = made[b].depthFile;
      node.depthScale = made[b].depthScale;
      MadeCell& making = made[b].made;
      Cell backdrop{{b}, std::move(making.cell.mesh), making.cell.quality};
      cutBorder(backdrop);  // the share of matched depth is unchanged: the border had none
      const MorphMesh& mesh = backdrop.mesh;
      report_.backdrops.push_back({input_.photographs[b].name, mesh.pointCount(), mesh.triangles.size(),
                                   backdrop.quality.coverage, making.seconds, making.resumed});
      scene_.backdrops.push_back(std::move(backdrop));
    }
  }

  void finish() {
    scene_.folder = options_.output;
    options_.postProcess(scene_, keptFolder(options_), progress_, log_);
    for (std::size_t c = 0; c < scene_.cells.size(); ++c) report_.cells[c].quality = scene_.cells[c].quality;
  }

  const BuildOptions& options_;
  const ProgressCallback& progress_;
  const LogCallback& log_;
  const BuildJobs jobs_;
  const fs::file_time_type begun_ = fs::file_time_type::clock::now();
  BuildInput input_;
  std::optional<CellPlanner> planner_;
  CellPlan plan_;
  std::map<std::uint32_t, std::string> failure_;  // of photographs whose cells failed: the last cell's message
  BuildReport report_;
  Scene scene_;
};

// Adds estimated poses to options without poses.
BuildOptions posed(BuildOptions options, const ProgressCallback& progress, const LogCallback& log) {
  if (!posesFile(options).empty()) return options;
  options.model = estimatePoses({.photographs = options.photographs,
                                 .folder = options.output / ".poses",
                                 .program = options.colmap,
                                 .threads = options.threads,
                                 .without = options.output / "images",
                                 .exclude = options.exclude,
                                 .orientation = options.orientation,
                                 .masks = options.masks},
                                progress, log)
                      .model;
  if (options.orientation == Orientation::automatic) options.orientation = Orientation::exif;  // as the files are
  return options;
}

// Options of a draft: skips what a preview does not need, and uses fast depth.
BuildOptions draftOf(BuildOptions options) {
  check(options.backdrops, ErrorCode::invalidInput, "a draft needs backdrops, because it has no cells");
  options.depth = DepthSearch::fast;
  options.refinePoses = options.removeMovers = options.fitVignetting = false;
  options.postProcess = nullptr;
  return options;
}

}  // namespace

BuildReport build(const BuildOptions& asked, const ProgressCallback& progress, const LogCallback& log) {
  const Stopwatch watch;
  checkOptions(asked);
  const BuildOptions options = asked.draft ? draftOf(asked) : asked;
  if (const std::string unread = unreadText(lookInto(options.photographs).unread); log && !unread.empty())
    log(LogLevel::warning, unread);
  const double before = processorSeconds();
  if (posesFile(options).empty() && options.onPrediction) {
    const SingleThreadedOpenCv quiet;
    BuildReport told;
    told.prediction = predictWithoutPoses(options);
    if (!options.onPrediction(told.prediction)) return told;
  }
  const BuildOptions known = posed(options, progress, log);
  BuildReport report = Builder(known, progress, log).run();
  report.seconds = watch.seconds();
  report.processorSeconds = processorSeconds() - before;
  report.memory = peakMemory();
  return report;
}

RefinedModel refinedModel(const BuildOptions& options, const ProgressCallback& progress, const LogCallback& log) {
  checkOptions(options);
  const BuildOptions known = posed(options, progress, log);
  return Builder(known, progress, log).runForPoses();
}

}  // namespace ibr
