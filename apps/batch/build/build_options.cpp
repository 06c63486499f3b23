// SPDX-License-Identifier: Apache-2.0
#include "batch/build/build_options.h"

#include <cstddef>
#include <vector>

#include "base/check.h"
#include "base/file.h"
#include "batch/build/optimise_options.h"
#include "batch/files/poses.h"
#include "shared/cli/options.h"
#include "shared/cli/progress.h"
#include "shared/cli/settings.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

// Looks for a model in the photographs' folder, or beside it in the parent folder.
fs::path findModel(const fs::path& photographs, const Context& context) {
  const fs::path parent = fs::weakly_canonical(photographs).parent_path();
  for (const fs::path& candidate :
       {photographs / "sparse", photographs / "sparse" / "0", parent / "sparse", parent / "sparse" / "0", photographs})
    if (holdsColmapModel(candidate)) {
      context.logMessage(LogLevel::info, "poses from {}", candidate.string());
      return candidate;
    }
  context.logMessage(
      LogLevel::info,
      "no poses given, and no COLMAP model in {} or in its parent folder: unless an earlier run did, COLMAP "
      "estimates the poses",
      photographs.string());
  return {};
}

std::vector<std::string> namesIn(const fs::path& file) {
  std::vector<std::string> names;
  std::string line;
  for (const char c : readTextFile(file) + '\n') {
    if (c != '\n') {
      line += c;
      continue;
    }
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
    if (!line.empty()) names.push_back(line);
    line.clear();
  }
  return names;
}

ScenePostProcess optimiser(AlignmentMethod method, const Context& context) {
  OptimiseCellsOptions options;
  options.alignment.method = method;
  options.alignment.seed = context.options().seed;
  options.threads = context.options().threads;
  const Aligner aligner = makeAligner(method, context);
  return [options, aligner](Scene& scene, const fs::path& cacheFolder, const ProgressCallback& progress,
                            const LogCallback& log) mutable {
    options.cacheFolder = cacheFolder;
    optimiseCells(scene, options, aligner, progress, log);
  };
}

void declareBuildSettings(CLI::App& app, BuildChoices& choices) {
  addFlag(app, "--draft", choices.build.draft,
          "Build a preview: fast depth search, no cells, nothing refined, removed or optimised. A later build "
          "reuses the estimated poses.");
  addOption(app, "--colmap", choices.build.colmap, "Program that estimates missing poses [colmap]").type("PROGRAM");
  addChoice<TrackSource>(
      app, "--tracks", choices.build.tracks,
      {{"auto", TrackSource::automatic}, {"model", TrackSource::model}, {"own", TrackSource::own}},
      "Source of points that photographs share: the model, own features, or own features where the model has few "
      "points [auto]");
  addChoice<RefinePoses>(
      app, "--refine-poses", choices.build.refinePoses,
      {{"auto", RefinePoses::automatic}, {"on", RefinePoses::on}, {"off", RefinePoses::off}},
      "on: first refine poses where points confirm the refinement, as ibr refine does; auto: only poses without points "
      "that a phone wrote, or whose photographs are a phone's by EXIF [auto]");
  addFlag(
      app, "--strip-metadata", choices.build.stripMetadata,
      "Store photographs without metadata such as location, time and camera; colour profile and orientation are kept");
  addFlag(app, "--keep-border", choices.build.keepBorder,
          "Keep all pixels of photographs with lens distortion; pixels without content are black and in no mesh "
          "[crop to the largest full rectangle]");
  addChoice<Orientation>(
      app, "--orientation", choices.build.orientation,
      {{"auto", Orientation::automatic}, {"stored", Orientation::stored}, {"exif", Orientation::exif}},
      "Orientation of photographs that EXIF marks as turned: as stored (as in COLMAP), or upright (exif) [auto: by "
      "aspect ratio]");
  addChoice<bool>(
      app, "--movers", choices.build.maskMovingObjects, {{"keep", false}, {"remove", true}},
      "Mask moving objects (people, cars) where another photograph shows the background; elsewhere, an object appears "
      "as in one photograph [keep]");
  addChoice<bool>(app, "--match-exposure", choices.build.matchExposures, {{"on", true}, {"off", false}},
                  "Measure exposure and white balance of the photographs, for --exposure of ibr render [on]");
  addChoice<bool>(app, "--vignetting", choices.build.fitVignetting, {{"fit", true}, {"off", false}},
                  "fit: measure the vignetting of lenses, and store photographs without vignetting [off]");
  addOption(app, "--exclude", choices.build.exclude, "Photographs to leave out, by name in the model").type("NAME...");
  addOption(app, "--exclude-from", choices.excludeFrom, "File of names to leave out, one per line").type("FILE");
  addParsed(
      app, "--memory",
      [&choices](const std::string& text) { choices.build.memory = double(parsedBytes("--memory", text)); },
      "Maximum memory of the build, such as 800M or 8G [half of the memory of the machine or container]")
      .type("BYTES");
  addInt(app, "--max-size", choices.build.maxSize, 0, 65536, "Longest side of stored photographs, px; 0 = unchanged");
  declareTextureFormat(app, choices.build.texture);
  addChoice<int>(app, "--dimension", choices.build.dimension, {{"auto", 0}, {"1", 1}, {"2", 2}, {"3", 3}},
                 "Maximum dimension of cells: lines (1), triangles (2) or tetrahedra (3) [auto: as the camera "
                 "positions span]");
  addChoice<MatchMethod>(app, "--matcher", choices.build.matcher,
                         {{"auto", MatchMethod::automatic},
                          {"sweep", MatchMethod::sweep},
                          {"homographic", MatchMethod::homographic},
                          {"flow", MatchMethod::flow}},
                         "Method that matches the photographs of a cell [auto: sweep where poses reproject to 1 px, "
                         "else flow]");
  addChoice<TriangleFilter>(
      app, "--triangle-filter", choices.build.triangleFilter,
      {{"consistency", TriangleFilter::consistency}, {"homogeneous", TriangleFilter::homogeneous}},
      "Triangles to blend: all that look alike in the photographs [consistency], or in a homographic match only those "
      "on one plane");
  addFlagCallback(
      app, "--no-backdrops", [&choices] { choices.build.backdrops = false; },
      "Build no meshes and textures of the depth of photographs; only cells draw views");
  addChoice<DepthSearch>(app, "--depth", choices.build.depth,
                         {{"fast", DepthSearch::fast},
                          {"swept", DepthSearch::swept},
                          {"refined", DepthSearch::refined},
                          {"fine", DepthSearch::fine}},
                         "Depth search in photographs and cells, against ten others: plane sweep (swept), at half size "
                         "(fast), refined by slanted planes, or refined at double size (fine) [refined]");
  addChoice<int>(app, "--backdrop-spacing", choices.build.backdropSpacing,
                 {{"2", 2}, {"4", 4}, {"8", 8}, {"16", 16}, {"32", 32}},
                 "Minimum vertex distance in the depth mesh of a photograph, in px of the photograph scaled to 512 px "
                 "(panoramas: 2048 px) [2]");
  addOption(app, "--cache", choices.build.cacheFolder,
            "Cache folder of matched cells and depth, for further builds of any scene [SCENE/.build: data of the last "
            "build only]")
      .type("DIR");
  addFlag(app, "--optimise{gradient}", choices.optimise,
          "Optimise the cells as ibr optimise does; --optimise=METHOD selects another method")
      .check([](const std::string& word) { parsedMethod("--optimise", word); });
}

}  // namespace

void declareInputOptions(CLI::App& app, BuildChoices& choices) {
  addOption(app, "--model,--transforms,--panoramas", choices.model,
            "Poses of another program; `ibr build --help-all` lists the formats [COLMAP model sparse or sparse/0 in "
            "PHOTOS or in its parent folder, "
            "else PHOTOS]")
      .type("FILE|DIR");
  addOption(app, "--masks", choices.build.masks,
            "Folder of masks, as in COLMAP: NAME.jpg.png or NAME.png, of the same size as the photograph; pixels with "
            "value 0 are neither matched nor shown")
      .type("DIR");
}

std::vector<Option> declareBuildOptions(CLI::App& app, BuildChoices& choices) {
  return declaredBy(app, [&] {
    declareInputOptions(app, choices);
    declareBuildSettings(app, choices);
  });
}

BuildOptions buildOptionsOf(const BuildChoices& choices, const fs::path& photographs, const Context& context) {
  check(fs::is_directory(photographs), ErrorCode::io, "{}: is not a folder of photographs", photographs.string());
  BuildOptions build = choices.build;
  build.photographs = photographs;
  build.model = choices.model.empty() ? findModel(photographs, context) : fs::path(choices.model);
  build.seed = context.options().seed;
  build.threads = context.options().threads;
  if (!choices.optimise.empty()) build.postProcess = optimiser(parsedMethod("--optimise", choices.optimise), context);
  if (!choices.excludeFrom.empty())
    for (std::string& name : namesIn(choices.excludeFrom)) build.exclude.push_back(std::move(name));
  return build;
}

}  // namespace ibr::app
