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

// Models are usually kept beside the photographs, or in the folder that holds their folder.
fs::path findModel(const fs::path& photographs, const Context& context) {
  const fs::path parent = fs::weakly_canonical(photographs).parent_path();
  for (const fs::path& candidate :
       {photographs / "sparse", photographs / "sparse" / "0", parent / "sparse", parent / "sparse" / "0", photographs})
    if (holdsColmapModel(candidate)) {
      context.say(LogLevel::info, "poses from {}", candidate.string());
      return candidate;
    }
  context.say(LogLevel::info, "no poses given, and no model in {} or beside it: COLMAP estimates them",
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

SceneFinisher optimiser(AlignmentMethod method, const Context& context) {
  OptimiseCellsOptions options;
  options.alignment.method = method;
  options.alignment.seed = context.options().seed;
  options.threads = context.options().threads;
  const Aligner aligner = makeAligner(method, context);
  return [options, aligner](Scene& scene, const fs::path& finished, const ProgressCallback& progress,
                            const LogCallback& log) mutable {
    options.finished = finished;
    optimiseCells(scene, options, aligner, progress, log);
  };
}

}  // namespace

void declareInputOptions(CLI::App& app, BuildChoices& choices) {
  app.add_option("--model", choices.model,
                 "Folder of the COLMAP model; without it, sparse and sparse/0 are looked for in PHOTOS and beside it")
      ->type_name("DIR");
  app.add_option("--transforms", choices.transforms,
                 "transforms.json (nerfstudio, instant-ngp) with the poses, instead of a model")
      ->type_name("FILE")
      ->excludes("--model");
  app.add_option("--panoramas", choices.panoramas, "File with the poses of panoramas, instead of a model")
      ->type_name("FILE")
      ->excludes("--model")
      ->excludes("--transforms");
  app.add_option(
         "--masks", choices.build.masks,
         "Folder of masks, as COLMAP has them: NAME.jpg.png or NAME.png, of the photograph's size, 0 where it is "
         "neither matched nor shown")
      ->type_name("DIR");
}

std::vector<CLI::Option*> declareBuildOptions(CLI::App& app, BuildChoices& choices) {
  const std::vector<CLI::Option*> before = app.get_options();
  declareInputOptions(app, choices);
  app.add_flag("--draft", choices.build.draft,
               "A first look: depth found fast, no cells, nothing refined, removed or optimised; poses that it had to "
               "estimate are those of the build after it");
  app.add_option("--colmap", choices.build.colmap, "Program that estimates poses where there are none [colmap]")
      ->type_name("PROGRAM");
  addChoice<TrackSource>(
      app, "--tracks", choices.build.tracks,
      {{"auto", TrackSource::automatic}, {"model", TrackSource::model}, {"own", TrackSource::own}},
      "Points that photographs share: the model's, our own, or our own where the model has few [auto]");
  addChoice<bool>(app, "--refine-poses", choices.build.refinePoses, {{"auto", true}, {"off", false}},
                  "auto: mend poses first where points confirm it, as ibr refine does (its --help) [off]");
  app.add_flag("--keep-border", choices.build.keepBorder,
               "Keep all of photographs whose lens distorts; what was not photographed is black and in no mesh [the "
               "largest full rectangle]");
  addChoice<Orientation>(
      app, "--orientation", choices.build.orientation,
      {{"auto", Orientation::automatic}, {"stored", Orientation::stored}, {"exif", Orientation::exif}},
      "How photographs that EXIF says are turned lie before their cameras: as stored (COLMAP), or upright [auto: as "
      "their shapes say]");
  addChoice<bool>(
      app, "--movers", choices.build.removeMovers, {{"keep", false}, {"remove", true}},
      "Mask who moved, people and cars, where another photograph shows the place without them; who hides what "
      "none shows is seen as one photograph has him [keep]");
  addChoice<bool>(app, "--match-exposure", choices.build.matchExposures, {{"on", true}, {"off", false}},
                  "Measure how photographs were exposed and white-balanced, for what render's --exposure shows [on]");
  addChoice<bool>(app, "--vignetting", choices.build.fitVignetting, {{"fit", true}, {"off", false}},
                  "fit: measure what lenses take from corners, and store photographs without it [off]");
  app.add_option("--exclude", choices.build.exclude, "Photographs to leave out, by their names in the model")
      ->type_name("NAME...");
  app.add_option("--exclude-from", choices.excludeFrom, "The same, from a file with a name a line")->type_name("FILE");
  app.add_option_function<std::string>(
         "--memory",
         [&choices](const std::string& text) { choices.build.memory = double(parsedBytes("--memory", text)); },
         "Memory that building may take, as 800M or 8G [half of what there is, or of what a container may have]")
      ->type_name("BYTES");
  addInt(app, "--max-size", choices.build.maxSize, 0, 65536, "Longest side of stored photographs; 0 = as they are");
  declareTextureFormat(app, choices.build.texture);
  addChoice<int>(app, "--dimension", choices.build.dimension, {{"auto", 0}, {"1", 1}, {"2", 2}, {"3", 3}},
                 "Cells are at most lines, triangles or tetrahedra [auto: what the places span]");
  addChoice<MatchMethod>(app, "--matcher", choices.build.matcher,
                         {{"auto", MatchMethod::automatic},
                          {"sweep", MatchMethod::sweep},
                          {"homographic", MatchMethod::homographic},
                          {"flow", MatchMethod::flow}},
                         "How members of a cell are matched [auto: sweep where poses reproject to 1 px, else flow]");
  addChoice<TriangleFilter>(
      app, "--triangle-filter", choices.build.triangleFilter,
      {{"consistency", TriangleFilter::consistency}, {"homogeneous", TriangleFilter::homogeneous}},
      "Blend all triangles that look alike [consistency], or of a homographic match only those on one plane");
  app.add_flag_callback(
      "--no-backdrops", [&choices] { choices.build.backdrops = false; },
      "Make no meshes and textures of photographs' depth: views are drawn by cells alone");
  addChoice<DepthSearch>(app, "--depth", choices.build.depth,
                         {{"fast", DepthSearch::fast},
                          {"swept", DepthSearch::swept},
                          {"refined", DepthSearch::refined},
                          {"fine", DepthSearch::fine}},
                         "How the depth of each photograph, and of the cells, is found: it is matched against ten "
                         "photographs, fast in pictures of half the sides; refined mends it by slanted planes, fine in "
                         "twice the sides [refined]");
  addChoice<int>(app, "--backdrop-spacing", choices.build.backdropSpacing,
                 {{"2", 2}, {"4", 4}, {"8", 8}, {"16", 16}, {"32", 32}},
                 "Least distance of vertices of a photograph's depth in px of a picture of 512 px [2]");
  app.add_option(
         "--cache", choices.build.finishedCells,
         "Keep matched cells and depth in this folder, for further builds of any scene [SCENE/.build: what its last "
         "build used]")
      ->type_name("DIR");
  app.add_flag("--optimise{gradient}", choices.optimise,
               "Optimise the cells as ibr optimise does, or, as --optimise=METHOD, another way")
      ->check([](const std::string& word) {
        parsedMethod("--optimise", word);
        return std::string();
      });
  const std::vector<CLI::Option*> all = app.get_options();  // in the order of their declaration
  return {all.begin() + std::ptrdiff_t(before.size()), all.end()};
}

BuildOptions buildOptionsOf(const BuildChoices& choices, const fs::path& photographs, const Context& context) {
  check(fs::is_directory(photographs), ErrorCode::io, "{}: is not a folder of photographs", photographs.string());
  BuildOptions build = choices.build;
  build.photographs = photographs;
  build.panoramas = choices.panoramas;
  build.transforms = choices.transforms;
  build.model = choices.model;
  if (choices.model.empty() && choices.transforms.empty() && choices.panoramas.empty())
    build.model = findModel(photographs, context);
  build.seed = context.options().seed;
  build.threads = context.options().threads;
  if (!choices.optimise.empty()) build.finish = optimiser(parsedMethod("--optimise", choices.optimise), context);
  if (!choices.excludeFrom.empty())
    for (std::string& name : namesIn(choices.excludeFrom)) build.exclude.push_back(std::move(name));
  return build;
}

}  // namespace ibr::app
