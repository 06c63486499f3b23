// SPDX-License-Identifier: Apache-2.0
// From posed photographs to a scene folder ([T] §2.4.1): model → cells → matches and meshes, a cell at a time → scene.
#include <fmt/format.h>

#include <algorithm>

#include "author/backdrop_maker.h"
#include "author/border.h"
#include "author/build_input.h"
#include "author/build_jobs.h"
#include "author/cell_maker.h"
#include "author/own_tracks.h"
#include "author/photographs.h"
#include "author/read_poses.h"
#include "author/stopwatch.h"
#include "ibr/author.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

constexpr double kLeastCoverage = 0.05;

class Builder {
 public:
  Builder(const BuildOptions& options, const ProgressCallback& progress, const LogCallback& log)
      : options_(options), log_(log), jobs_(options.threads, progress) {}

  BuildReport run() {
    const Stopwatch watch;
    jobs_.step("reading the model", 0, 1);
    input_ = readInput(options_, log_);
    report_.poses = posesFile(options_);
    const SingleThreadedOpenCv quiet;
    storePhotographs();
    addOwnTracks(input_, options_, jobs_, log_);
    report_.dropped = input_.dropped;
    report_.dropped.insert(report_.dropped.end(), input_.plan.dropped.begin(), input_.plan.dropped.end());
    describe();
    makeCells();
    if (options_.backdrops) makeBackdrops();
    jobs_.step("writing the scene", 0, 1);
    saveScene(scene_, options_.output);
    if (options_.finishedCells.empty()) fs::remove_all(keptFolder(options_));
    report_.seconds = watch.seconds();
    return std::move(report_);
  }

 private:
  void storePhotographs() {
    fs::create_directories(keptFolder(options_));
    input_.hashes.resize(input_.photographs.size());
    double bytes = 0;
    for (const Photograph& photo : input_.photographs) bytes = std::max(bytes, bytesToStore(photo));
    jobs_.runAll("storing photographs", input_.photographs.size(), bytes, [&](std::size_t i) {
      input_.hashes[i] = storePhotograph(input_.photographs[i], options_.output, options_.texture);
    });
    for (const Photograph& photo : input_.photographs)
      scene_.nodes.push_back({photo.name, photo.camera, photo.imageFile, photo.textureFile});
  }

  void describe() {
    const bool panoramic = std::ranges::all_of(input_.photographs, isPanorama);
    scene_.acquisition = panoramic ? "panoramic" : input_.plan.ordered ? "ordered" : "unordered";
    scene_.settings = fmt::format(
        R"({{"dimension":{},"maxSize":{},"texture":"{}","thetaDegrees":{},"seed":{},"refine":{},"backdrops":{},)"
        R"("backdropSpacing":{},"tracks":"{}","keepBorder":{}}})",
        options_.dimension, options_.maxSize, textureFormatName(options_.texture), options_.thetaDegrees, options_.seed,
        input_.refine, options_.backdrops, options_.backdropSpacing, trackSourceName(options_.tracks),
        options_.keepBorder);
  }

  void makeCells() {
    const CellMaker maker(input_, options_);
    const auto& plan = input_.plan.cells;
    std::vector<MadeCell> made(plan.size());
    jobs_.runAll("matching cells", plan.size(), maker.bytes(), [&](std::size_t c) { made[c] = maker.make(plan[c]); });
    for (std::size_t c = 0; c < plan.size(); ++c) take(plan[c], std::move(made[c]));
  }

  std::vector<std::string> namesOf(const std::vector<std::uint32_t>& members) const {
    std::vector<std::string> names;
    for (const std::uint32_t i : members) names.push_back(input_.photographs[i].name);
    return names;
  }

  // The share of tier 0 that is left.
  double cutBorder(Cell& cell) const {
    if (!options_.keepBorder) return 1;
    std::vector<const Photograph*> members;
    for (const std::uint32_t i : cell.members) members.push_back(&input_.photographs[i]);
    return dropBorder(cell.mesh, members);
  }

  void take(const std::vector<std::uint32_t>& members, MadeCell made) {
    Cell cell{members, std::move(made.cell.mesh), made.cell.quality};
    cell.quality.coverage *= cutBorder(cell);
    if (!(cell.quality.coverage >= kLeastCoverage)) {
      report_.dropped.push_back({fmt::format("{}", fmt::join(namesOf(members), ", ")),
                                 fmt::format("its members agree on {:.1f} % of their picture, less than {:.0f} %",
                                             100 * cell.quality.coverage, 100 * kLeastCoverage)});
      return;
    }
    report_.cells.push_back({namesOf(members), cell.mesh.pointCount(), cell.mesh.triangles.size(),
                             cell.mesh.tier0Count(), cell.quality, made.seconds, made.resumed});
    scene_.cells.push_back(std::move(cell));
    keys_.push_back(made.key);
  }

  void makeBackdrops() {
    std::vector<std::uint32_t> pinholes;
    for (std::uint32_t i = 0; i < input_.photographs.size(); ++i)
      if (!isPanorama(input_.photographs[i])) pinholes.push_back(i);
    const BackdropMaker maker(input_, options_, scene_, keys_);
    std::vector<MadeCell> made(pinholes.size());
    jobs_.runAll("completing backdrops", made.size(), kBytesOfBackdrop,
                 [&](std::size_t b) { made[b] = maker.make(pinholes[b]); });
    for (std::size_t b = 0; b < made.size(); ++b) {
      Cell backdrop{{pinholes[b]}, std::move(made[b].cell.mesh), made[b].cell.quality};
      cutBorder(backdrop);
      const MorphMesh& mesh = backdrop.mesh;
      report_.backdrops.push_back({input_.photographs[pinholes[b]].name, mesh.pointCount(), mesh.triangles.size(),
                                   made[b].cell.quality.coverage, made[b].seconds, made[b].resumed});
      scene_.backdrops.push_back(std::move(backdrop));
    }
  }

  const BuildOptions& options_;
  const LogCallback& log_;
  const BuildJobs jobs_;
  BuildInput input_;
  BuildReport report_;
  Scene scene_;
  std::vector<std::uint64_t> keys_;  // of scene_.cells
};

}  // namespace

BuildReport build(const BuildOptions& options, const ProgressCallback& progress, const LogCallback& log) {
  BuildOptions posed = options;
  checkOptions(options);
  if (posesFile(options).empty())
    posed.model = estimatePoses({options.photographs, options.output / ".poses", options.colmap, options.threads},
                                progress, log)
                      .model;
  return Builder(posed, progress, log).run();
}

}  // namespace ibr
