// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "base/check.h"
#include "base/file.h"
#include "batch/build_options.h"
#include "batch/command.h"
#include "batch/pose_errors.h"
#include "batch/refinement_report.h"
#include "ibr/refine_poses.h"
#include "shared/progress.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  BuildChoices choices;
  std::string photographs, output, truth;
};

// Of the same photographs as those after.
PosedModel posesBefore(const BuildOptions& build, const PosedModel& after) {
  const PosedPhotographs photographs(build);
  PosedModel before;
  for (const PosedImage& image : photographs.images())
    if (std::ranges::find(after.images, image.name, &PosedImage::name) != after.images.end())
      before.images.push_back(image);
  return before;
}

ExitCode refine(const Options& options, const Context& context) {
  BuildOptions build = buildOptionsOf(options.choices, options.photographs, context);
  build.output = options.output;
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
  context.print("{}{}: the model, refined\n", text(refined.refinement), options.output);
  Json report{{"model", options.output}, {"refinement", json(refined.refinement)}};
  if (truth) {
    const PoseErrors before = poseErrors(posesBefore(build, refined.model), *truth);
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
        "ibr refine photographs --model noisy -o refined --truth exact",
    .details =
        "Cells are matched as ibr build matches them, and one bundle adjustment over the matches of all cells and the "
        "model's points makes poses, focal lengths and principal points agree; place, direction and scale of the world "
        "stay. ibr build --refine-poses auto does the same first; this is for poses that several commands are to "
        "share. It takes about as long as a build. Options are those of ibr build; of them, what only changes how the "
        "scene is stored does nothing.\n\nIt helps where poses are off by about a pixel or more. What an estimator has "
        "settled to parts of a pixel it does not better and may worsen: compare by ibr eval --leave-one-out, with "
        "--refine-poses auto and without. MODEL is a COLMAP model in text. Focal lengths of lenses that distort stay. "
        "Poses stay where the model's points reproject exactly. Parts of a model that share no points are each mended "
        "by themselves.",
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
