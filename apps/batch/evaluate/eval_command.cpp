// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "author/photographs/masks.h"
#include "base/check.h"
#include "batch/build/build_options.h"
#include "batch/command.h"
#include "batch/evaluate/evaluator.h"
#include "batch/evaluate/leave_one_out.h"
#include "batch/files/poses.h"
#include "batch/files/truth.h"
#include "io/image_file.h"
#include "shared/cli/options.h"
#include "shared/cli/presets.h"
#include "shared/cli/progress.h"
#include "shared/cli/settings.h"

namespace ibr::app {
namespace {

struct Options {
  std::string scene, truth, output;
  std::vector<std::string> views;
  EvaluationOptions evaluation;
  LeaveOneOutOptions leaveOneOut;
  BuildChoices build;
};

// Of a view whose truth has one below the folder, else empty. Throws Error that names the file.
Image8 maskOf(const std::string& view, const Image8& truth, const std::filesystem::path& folder) {
  const auto file = folder.empty() ? std::nullopt : maskFileOf(folder, view);
  if (!file) return {};
  const Image8 picture = readImage(*file);
  check(picture.width == truth.width && picture.height == truth.height, ErrorCode::invalidInput,
        "{}: the mask is {} × {} px, the truth {} × {}", file->string(), picture.width, picture.height, truth.width,
        truth.height);
  Image8 mask(picture.width, picture.height, 1);
  for (std::size_t p = 0; p < mask.values.size(); ++p)
    mask.values[p] = picture.values[p * std::size_t(picture.channels)] ? 255 : 0;
  return mask;
}

ExitCode evaluate(const Options& options, const Context& context) {
  const Scene scene = loadScene(options.scene);
  const Truth truth(options.truth, options.views, context.log());
  const std::vector<View>& views = truth.views();
  if (!options.evaluation.pictures.empty()) {
    checkNamesDiffer(views);
    for (const View& view : views) evaluationFiles(options.evaluation, view.name);
  }
  context.say(LogLevel::info, "settings: {}", presetText(options.evaluation.settings));
  Evaluator evaluator(scene, views, options.evaluation, context);
  std::vector<ViewOutcome> outcomes;
  {
    ProgressLine progress(context);
    for (std::size_t i = 0; i < views.size(); ++i) {
      check(progress.show({"evaluating", i, views.size()}), ErrorCode::cancelled, "stopped");
      const Image8 picture = truth.picture(views[i]);
      outcomes.push_back(
          evaluator.evaluate(views[i], picture, maskOf(views[i].name, picture, options.build.build.masks)));
    }
    progress.show({"evaluating", views.size(), views.size()});
  }
  reportOutcomes(outcomes, options.evaluation,
                 {{"device", evaluator.deviceName()},
                  {"settings", settingsJson(options.evaluation.settings, options.evaluation.gpuScene)},
                  {"scene", options.scene}},
                 context);
  return kExitOk;
}

// All where none is named. Throws CLI::ValidationError for a name that is none of kBaselines.
std::vector<std::string> chosenBaselines(std::vector<std::string> names) {
  std::erase(names, "");
  std::vector<std::string> known;
  for (const auto& [name, title] : kBaselines) known.emplace_back(name);
  for (const std::string& name : names)
    if (std::ranges::find(known, name) == known.end())
      throw CLI::ValidationError("--baselines", fmt::format("{} is none of {}", name, fmt::join(known, ", ")));
  return names.empty() ? known : names;
}

// Options that were given, with their values, but for those that change no score.
std::vector<std::string> wordsThatCount(const CLI::App& app) {
  static const std::set<std::string> kNotThese{"--leave-one-out", "--every", "--views",   "--work",   "--output",
                                               "--json",          "--quiet", "--verbose", "--threads"};
  return givenWords(app, kNotThese);
}

}  // namespace

const Command kEvalCommand{
    .name = "eval",
    .summary = "Compares rendered views with photographs that were held out",
    .examples =
        "ibr eval scene --truth held-out\n"
        "ibr eval scene --truth photographs --views IMG_0007.jpg IMG_0015.jpg -o compared --baselines\n"
        "ibr eval scene --truth held-out --cells 1 --tiers 0 --json -\n"
        "ibr eval --leave-one-out photographs --model colmap/sparse/0 --every 3 -o compared",
    .details =
        "--truth DIR has images/ and a COLMAP model in sparse/ (or both in DIR). --leave-one-out builds a scene "
        "without each photograph and renders its view; options of ibr build apply. Depth is matched once for all "
        "views where the photograph that is left out takes no part in it and points are the model's. With "
        "--refine-poses auto, what is left out takes no part in it; --refine-poses off --resect is what it "
        "compares with. "
        "PSNR is on 8-bit values; holes count as black in PSNR, SSIM and FLIP and are left out of the 'covered' "
        "columns. What a mask of the truth covers (--masks) is left out of all of them. "
        "-o writes prediction, truth and four times the difference side by side. ms is the time from planning until "
        "the "
        "picture is on the host. In JSON, PSNR is null where nothing is covered and where pictures are equal.",
    .afterInterrupt = "What was finished of --leave-one-out is kept: run the same command again.",
    .declare = [](CLI::App& app) -> std::function<ExitCode(const Context&)> {
      const auto options = std::make_shared<Options>();
      EvaluationOptions& evaluation = options->evaluation;
      auto* scene = app.add_option("SCENE", options->scene, "Scene folder");
      auto* truth =
          app.add_option("--truth", options->truth, "Held-out photographs with their poses")->type_name("DIR");
      auto* rebuilt = app.add_option("--leave-one-out", options->leaveOneOut.photographs,
                                     "Build without each of these photographs, and compare with it")
                          ->type_name("PHOTOS");
      rebuilt->excludes(scene)->excludes(truth);
      app.add_option("--views", options->views, "Only these views, by name")->type_name("NAME...");
      app.add_option("-o,--output", options->output, "Folder for prediction, truth and difference")->type_name("DIR");
      app.add_flag("--seams", evaluation.seams,
                   "Also the step in colour from cell to cell beyond the truth's, in levels, and the colour difference "
                   "(CIE 1976) that one gain a channel leaves; and how many pixels apart cells show the same "
                   "places of shared photographs (median and 95 %), drawn and had they not been aligned (--align)");
      app.add_flag("--fit-gain", evaluation.fitGain,
                   "Also PSNR after one gain a channel, the median ratio: exposures of photographs differ");
      auto* baselines =
          app.add_option("--baselines", evaluation.baselines,
                         "Also other ways to show the same photographs: the nearest one by homography (nearest), an "
                         "unstructured lumigraph on the matches' depth (lumigraph), a cross-fade without morphing "
                         "(crossFade), the paper's morph (paper), the paper's order (paperOrder), the reference "
                         "composer, which votes for depth and gathers colours (gathered); without names all")
              ->type_name("NAME...")
              ->expected(0, int(kBaselines.size()));
      app.add_flag("--guessed", evaluation.guessed,
                   "Also, in JSON, the share of pixels whose depth was completed or filled");
      auto* depth = app.add_option("--truth-depth", evaluation.truthDepth,
                                   "Exact depth of the views, NAME.png of 16 bits each: also the share of pixels whose "
                                   "drawn depth is right, too far or too near, without sky")
                        ->type_name("DIR");
      addDouble(app, "--depth-unit", evaluation.depthUnit, 1e-9, 1e9,
                "World units that one step of a depth picture stands for")
          ->needs(depth);
      addDouble(app, "--depth-baseline", evaluation.depthBaseline, 1e-9, 1e9,
                "Depth is right where seen from so far beside it moves by at most 1 px, world units")
          ->needs(depth);
      declareSettings(app, evaluation.settings);
      declareGpuScene(app, evaluation.gpuScene);
      std::vector<CLI::Option*> only{addInt(app, "--every", options->leaveOneOut.every, 1, 1000000,
                                            "Of --leave-one-out: hold every Nth photograph out")};
      only.push_back(app.add_option("--work", options->leaveOneOut.work,
                                    "Of --leave-one-out: folder for what is built; kept, so that the next run with "
                                    "other settings need not match again [a temporary one, gone at the end]")
                         ->type_name("DIR"));
      only.push_back(app.add_flag("--resect", options->leaveOneOut.resect,
                                  "Of --leave-one-out: poses of what is left out are found anew, by the points that it "
                                  "shares with the others; as they are wherever --refine-poses moves these"));
      for (CLI::Option* option : declareBuildOptions(app, options->build))
        if (option->get_name() != "--masks") only.push_back(option);  // of the truth: there it does not count
      for (CLI::Option* option : only) option->needs(rebuilt);
      app.callback([options, baselines, &app] {
        if (baselines->count() > 0) options->evaluation.baselines = chosenBaselines(options->evaluation.baselines);
        if (!options->leaveOneOut.photographs.empty()) {
          options->leaveOneOut.words = wordsThatCount(app);
          return;
        }
        if (options->scene.empty()) throw CLI::RequiredError("SCENE (or --leave-one-out)");
        if (options->truth.empty()) throw CLI::RequiredError("--truth (or --leave-one-out)");
      });
      return [options](const Context& context) {
        options->evaluation.pictures = options->output;
        if (options->leaveOneOut.photographs.empty()) return evaluate(*options, context);
        options->leaveOneOut.views = options->views;
        return leaveOneOut(options->leaveOneOut, options->build, options->evaluation, context);
      };
    }};

}  // namespace ibr::app
