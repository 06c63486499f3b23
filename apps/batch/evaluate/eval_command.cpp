// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "base/check.h"
#include "batch/build/build_options.h"
#include "batch/command.h"
#include "batch/evaluate/evaluator.h"
#include "batch/evaluate/leave_one_out.h"
#include "batch/files/poses.h"
#include "batch/files/truth.h"
#include "ibr/author/photographs.h"
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

// Reads a view's mask from the folder; empty if there is none. Throws Error that names the file.
Image8 maskOf(const std::string& view, const Image8& truth, const std::filesystem::path& folder) {
  const auto file = folder.empty() ? std::nullopt : findMaskFile(folder, view);
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
  context.logMessage(LogLevel::info, "settings: {}", presetText(options.evaluation.settings));
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

// Returns all baselines if none is named. Refuses a name that is not in kBaselines.
std::vector<std::string> chosenBaselines(std::vector<std::string> names) {
  std::erase(names, "");
  std::vector<std::string> known;
  for (const auto& [name, title] : kBaselines) known.emplace_back(name);
  for (const std::string& name : names)
    if (std::ranges::find(known, name) == known.end())
      refuseOption("--baselines", fmt::format("unknown baseline {}; choose from {}", name, fmt::join(known, ", ")));
  return names.empty() ? known : names;
}

// Given options with their values, except those that do not affect scores.
std::vector<std::string> scoreArguments(const CLI::App& app) {
  static const std::set<std::string> kExcludedOptions{"--leave-one-out", "--every", "--views",   "--work",   "--output",
                                                      "--json",          "--quiet", "--verbose", "--threads"};
  return givenArguments(app, kExcludedOptions);
}

}  // namespace

const Command kEvalCommand{
    .name = "eval",
    .summary = "Compares rendered views with held-out photographs",
    .examples =
        "ibr eval scene --truth held-out\n"
        "ibr eval scene --truth photographs --views IMG_0007.jpg IMG_0015.jpg -o compared --baselines\n"
        "ibr eval scene --truth held-out --cells 1 --tiers 0 --json -\n"
        "ibr eval --leave-one-out photographs --model colmap/sparse/0 --every 3 -o compared",
    .details =
        "--truth DIR has images/ and a COLMAP model in sparse/ (or both in DIR). --leave-one-out\n"
        "builds a scene without each photograph and renders its view; options of ibr build apply.\n"
        "Depth that does not depend on the held-out photograph is matched once for all views, if\n"
        "points come from the model. --refine-poses on refines poses without the held-out\n"
        "photograph. The baseline for comparison is --refine-poses off --resect.\n"
        "PSNR is computed on 8-bit values. Holes count as black in PSNR, SSIM and FLIP, and are\n"
        "left out of the 'covered' columns. Pixels that a mask of the truth covers (--masks) are\n"
        "left out of all columns. -o writes prediction, truth and four times the difference side\n"
        "by side. ms is the time from planning until the image is on the host. In JSON, PSNR is\n"
        "null for views without covered pixels and for equal images.",
    .afterInterrupt = "finished views of --leave-one-out are cached; run the same command again to resume",
    .mainOptions = "truth leave-one-out views output preset fit-gain baselines seams guessed json",
    .declare = [](CLI::App& app) -> std::function<ExitCode(const Context&)> {
      const auto options = std::make_shared<Options>();
      EvaluationOptions& evaluation = options->evaluation;
      const Option scene = addOption(app, "SCENE", options->scene, "Scene folder");
      const Option truth =
          addOption(app, "--truth", options->truth, "Held-out photographs with their poses").type("DIR");
      const Option rebuilt =
          addOption(app, "--leave-one-out", options->leaveOneOut.photographs,
                    "Build without each of these photographs, and compare with the held-out photograph")
              .type("PHOTOS");
      rebuilt.excludes(scene).excludes(truth);
      addOption(app, "--views", options->views, "Compare only these views, by name").type("NAME...");
      addOption(app, "-o,--output", options->output, "Folder for prediction, truth and difference").type("DIR");
      addFlag(app, "--seams", evaluation.seams,
              "Also measure colour steps between cells beyond the truth's, in levels; colour difference (CIE "
              "1976) after one gain per channel; misalignment of cells in px (median, 95 %), with and without "
              "--align");
      addFlag(app, "--fit-gain", evaluation.fitGain,
              "Also measure PSNR after one gain per channel, the median ratio, because exposures of photographs "
              "differ");
      const Option baselines =
          addOption(app, "--baselines", evaluation.baselines,
                    "Also measure baselines: nearest (photograph by homography); lumigraph (unstructured, on "
                    "matched depth); crossFade (no morph); paper (the paper's morph and order); paperOrder (the "
                    "paper's order); gathered (reference implementation of the gather); without names: all")
              .type("NAME...")
              .expected(0, int(kBaselines.size()));
      addFlag(app, "--guessed", evaluation.guessed,
              "Also report, in JSON, the share of pixels whose depth was completed or filled");
      const Option depth = addOption(app, "--truth-depth", evaluation.truthDepth,
                                     "Folder of exact depth, a 16-bit NAME.png per view, to report the share of pixels "
                                     "with right, too far or too near depth, without sky")
                               .type("DIR");
      addDouble(app, "--depth-unit", evaluation.depthUnit, 1e-9, 1e9, "World units per step of a depth image")
          .needs(depth);
      addDouble(app, "--depth-baseline", evaluation.depthBaseline, 1e-9, 1e9,
                "Baseline at which a depth error may cause at most 1 px of parallax to count as right, world units")
          .needs(depth);
      declareAllSettings(app, evaluation.settings);
      declareGpuScene(app, evaluation.gpuScene);
      std::vector<Option> only{addInt(app, "--every", options->leaveOneOut.every, 1, 1000000,
                                      "--leave-one-out: hold out every Nth photograph")};
      only.push_back(addOption(app, "--work", options->leaveOneOut.work,
                               "--leave-one-out: folder that caches builds, so that a run with other settings "
                               "does not match again [a temporary folder]")
                         .type("DIR"));
      only.push_back(addFlag(app, "--resect", options->leaveOneOut.resect,
                             "--leave-one-out: estimate held-out poses from points shared with other photographs; "
                             "always on where --refine-poses moves these"));
      for (const Option& option : declareBuildOptions(app, options->build))
        if (option.name() != "--masks") only.push_back(option);  // --masks also applies with --truth
      for (const Option& option : only) option.needs(rebuilt);
      afterParsing(app, [options, baselines, &app] {
        if (baselines.isSet()) options->evaluation.baselines = chosenBaselines(options->evaluation.baselines);
        if (!options->leaveOneOut.photographs.empty()) {
          options->leaveOneOut.words = scoreArguments(app);
          return;
        }
        if (options->scene.empty()) requireOption("SCENE (or --leave-one-out)");
        if (options->truth.empty()) requireOption("--truth (or --leave-one-out)");
      });
      return [options](const Context& context) {
        options->evaluation.pictures = options->output;
        if (options->leaveOneOut.photographs.empty()) return evaluate(*options, context);
        options->leaveOneOut.views = options->views;
        return leaveOneOut(options->leaveOneOut, options->build, options->evaluation, context);
      };
    }};

}  // namespace ibr::app
