// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <nlohmann/json.hpp>

#include "base/check.h"
#include "base/file.h"
#include "batch/build/build_options.h"
#include "batch/build/pose_errors.h"
#include "batch/build/refinement_report.h"
#include "batch/command.h"
#include "ibr/author/build.h"
#include "shared/cli/options.h"
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
          "{}: -o would overwrite the model {}; choose another folder", options.output, given.string());
  }
  std::optional<PosedModel> truth;
  if (!options.truth.empty()) {
    check(!build.model.empty(), ErrorCode::invalidInput, "{}: no poses to compare with --truth; give them with --model",
          options.photographs);
    truth = readPoseFile(options.truth, build.photographs, context.log());
  }
  RefinedModel refined;
  {
    ProgressLine progress(context);
    refined = refineModelPoses(build, progress.callback(), context.log());
  }
  writeColmapModel(refined.model, options.output);
  context.print("{}{}: model written, {}\n", text(refined.refinement), options.output,
                refined.refinement.poseChanges.empty() ? "unchanged" : "refined");
  Json report{{"model", options.output}, {"refinement", json(refined.refinement)}};
  if (truth) {
    const PoseErrors before = poseErrors(posesBefore(build), *truth);
    const PoseErrors after = poseErrors(refined.model, *truth);
    context.print("pose errors before: {}\npose errors after:  {}\n", text(before), text(after));
    report["truth"] = {{"before", json(before)}, {"after", json(after)}};
  }
  context.report(report);
  return kExitOk;
}

}  // namespace

const Command kRefineCommand{
    .name = "refine",
    .summary = "Refines poses and focal lengths with matches of all photographs",
    .examples =
        "ibr refine photographs -o refined\n"
        "ibr refine photographs --model colmap/sparse/0 -o refined --max-size 1600\n"
        "ibr refine photographs --model colmap/sparse/0 -o refined --masks masks\n"
        "ibr refine photographs --model noisy -o refined --truth exact",
    .details =
        "Cells are matched as in ibr build. The first bundle adjustment uses the points of the\n"
        "model, the second one also the points of all cells. A third one also refines focal\n"
        "lengths and principal points. Position, orientation and scale of the world stay fixed.\n"
        "Each step is accepted only if a cross-validation confirms the step. For this, a fit to\n"
        "half of the points must improve the other half by 3 standard errors. Both the points of\n"
        "cells and the points of the model must improve. Accurate poses are mostly kept, and the\n"
        "report states this.\n"
        "ibr build --refine-poses on runs the same refinement first. Use ibr refine if several\n"
        "commands share the poses. A refinement takes about as long as a build. The options are\n"
        "those of ibr build; options that only change the stored scene have no effect.\n\n"
        "MODEL is a COLMAP model in text. Intrinsics of distorting lenses stay fixed. Poses stay\n"
        "fixed where the points of the model reproject exactly. Parts of a model that share no\n"
        "points are refined separately.",
    .afterInterrupt = "finished work is cached; run the same command again to resume",
    .mainOptions = "output truth model masks tracks exclude-from cache json",
    .declare = [](CLI::App& app) -> std::function<ExitCode(const Context&)> {
      const auto options = std::make_shared<Options>();
      addOption(app, "PHOTOS", options->photographs, "Folder of the photographs").required();
      addOption(app, "-o,--output", options->output, "Folder of the refined model; created if missing")
          .required()
          .type("MODEL");
      addOption(app, "--truth", options->truth,
                "Exact poses, in any format of --model, to report the pose errors before and after refinement, after "
                "alignment by "
                "a similarity")
          .type("DIR");
      declareBuildOptions(app, options->choices);
      return [options](const Context& context) { return refine(*options, context); };
    }};

}  // namespace ibr::app
