// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <memory>

#include "base/check.h"
#include "base/file.h"
#include "batch/build/build_options.h"
#include "batch/build/pose_errors.h"
#include "batch/build/refinement_report.h"
#include "batch/command.h"
#include "ibr/refine_poses.h"
#include "shared/cli/progress.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  BuildChoices choices;
  std::string photographs, output, truth;
};

PosedModel posesBefore(const BuildOptions& build) {
  PosedModel before;
  before.images = PosedPhotographs(build).images();
  return before;
}

ExitCode refine(const Options& options, const Context& context) {
  BuildOptions build = buildOptionsOf(options.choices, options.photographs, context);
  build.output = options.output;
  for (const fs::path& given : {build.model, fs::path(options.truth)}) {
    std::error_code ignored;
    check(given.empty() || !fs::equivalent(given, options.output, ignored), ErrorCode::invalidInput,
          "{}: -o would overwrite the model {}; name another folder for what is refined", options.output,
          given.string());
  }
  std::optional<PosedModel> truth;
  if (!options.truth.empty()) {
    check(!build.model.empty() || !build.transforms.empty(), ErrorCode::invalidInput,
          "{}: has no poses to compare with the truth: give a COLMAP model with --model, or --transforms",
          options.photographs);
    truth = readColmapModel(options.truth, context.log());
  }
  RefinedModel refined;
  {
    ProgressLine progress(context);
    refined = refinedModel(build, progress.callback(), context.log());
  }
  writeColmapModel(refined.model, options.output);
  context.print("{}{}: the model, {}\n", text(refined.refinement), options.output,
                refined.refinement.moved.empty() ? "as it was" : "refined");
  Json report{{"model", options.output}, {"refinement", json(refined.refinement)}};
  if (truth) {
    const PoseErrors before = poseErrors(posesBefore(build), *truth);
    const PoseErrors after = poseErrors(refined.model, *truth);
    context.print("off the truth before: {}\noff the truth after:  {}\n", text(before), text(after));
    report["truth"] = {{"before", json(before)}, {"after", json(after)}};
  }
  context.report(report.dump(2, ' ', false, Json::error_handler_t::replace));
  return kExitOk;
}

}  // namespace

const Command kRefineCommand{
    .name = "refine",
    .summary = "Refines poses and focal lengths by what matching says about all photographs",
    .examples =
        "ibr refine photographs -o refined\n"
        "ibr refine photographs --model colmap/sparse/0 -o refined --max-size 1600\n"
        "ibr refine photographs --model colmap/sparse/0 -o refined --masks masks\n"
        "ibr refine photographs --model noisy -o refined --truth exact",
    .details =
        "Cells are matched as ibr build matches them; bundle adjustments over the model's points, then those of all "
        "cells as well, then with focal lengths and principal points, make poses agree; place, direction and scale of "
        "the world stay. Each is taken only if, made with half of the points, it suits the other half better, those of "
        "cells and those of the model, by 3 standard errors: poses that an estimator has settled are mostly kept, and "
        "the report says so. ibr build --refine-poses auto does the same first; this is for poses that several "
        "commands are to share. It takes about as long as a build. Options are those of ibr build; of them, what only "
        "changes how the scene is stored does nothing.\n\nMODEL is a COLMAP model in text. Intrinsics of lenses that "
        "distort stay. Poses stay where the model's points reproject exactly. Parts of a model that share no points "
        "are each mended by themselves.",
    .afterInterrupt = "What was finished is kept: run the same command again to go on.",
    .declare = [](CLI::App& app) -> std::function<ExitCode(const Context&)> {
      const auto options = std::make_shared<Options>();
      app.add_option("PHOTOS", options->photographs, "Folder of the photographs")->required();
      app.add_option("-o,--output", options->output, "Folder of the refined model; made where it is missing")
          ->required()
          ->type_name("MODEL");
      app.add_option(
             "--truth", options->truth,
             "COLMAP model whose poses are exact: also tells how far off the poses are before and after, brought "
             "onto it by a similarity")
          ->type_name("DIR");
      declareBuildOptions(app, options->choices);
      return [options](const Context& context) { return refine(*options, context); };
    }};

}  // namespace ibr::app
