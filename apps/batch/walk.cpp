// SPDX-License-Identifier: Apache-2.0
// How steady and how whole a walk is: every frame is rendered and compared with the one before it.
//
// A step is the mean absolute difference between neighbouring frames, in levels. Motion alone makes steps; a switch of
// the main cell that cannot be seen makes none larger than they are.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>

#include "base/check.h"
#include "batch/command.h"
#include "batch/poses.h"
#include "batch/union_of_views.h"
#include "ibr/metrics.h"
#include "io/image_file.h"
#include "shared/auto_path.h"
#include "shared/options.h"
#include "shared/pictures.h"
#include "shared/progress.h"
#include "shared/scene_renderer.h"
#include "shared/settings.h"
#include "shared/statistics.h"
#include "shared/table.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kTierCount = kTierFilled + 1;
constexpr int kDifferenceGain = 4;

struct Options {
  std::string scene, poses, output;
  int autoFrames = 300;
  PictureSize size;
  RenderSettings settings;
  GpuSceneOptions gpuScene;
};

struct Frame {
  std::int64_t mainCell = -1;
  bool switching = false;  // between a switch of the main cell and the end of its mixture
  double step = NAN;       // from the frame before, levels; NaN for the first
  double coverage = 0;
  double coverageInside = NAN;  // of the pixels that some photograph sees; NaN where none does
  std::array<double, kTierCount> tier{};
};

void measureTiers(const Image8& image, const UnionOfViews& photographs, const Camera& camera, Frame& frame) {
  frame.tier = tierShares(image);
  frame.coverage = std::accumulate(frame.tier.begin(), frame.tier.end(), 0.0);
  std::size_t inside = 0, covered = 0;
  for (const glm::ivec2 pixel : photographs.pixelsSeen(camera)) {
    ++inside;
    covered += image.values[4 * (std::size_t(pixel.y) * std::size_t(image.width) + std::size_t(pixel.x)) + 3] > 0;
  }
  if (inside > 0) frame.coverageInside = double(covered) / double(inside);
}

struct Summary {
  double medianStep = NAN, largestStep = NAN, largestStepAtSwitch = NAN;
  std::size_t switches = 0;
  double leastCoverage = 1, leastCoverageInside = 1, meanCoverageInside = 0;
  std::array<double, kTierCount> tier{};
};

Summary summaryOf(const std::vector<Frame>& frames) {
  Summary summary;
  std::vector<double> steps;
  std::size_t withInside = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const Frame& frame = frames[i];
    if (!std::isnan(frame.step)) {
      steps.push_back(frame.step);
      summary.largestStep = std::fmax(summary.largestStep, frame.step);
      if (frame.switching) summary.largestStepAtSwitch = std::fmax(summary.largestStepAtSwitch, frame.step);
    }
    summary.switches += i > 0 && frame.mainCell != frames[i - 1].mainCell;
    summary.leastCoverage = std::min(summary.leastCoverage, frame.coverage);
    if (!std::isnan(frame.coverageInside)) {
      ++withInside;
      summary.leastCoverageInside = std::min(summary.leastCoverageInside, frame.coverageInside);
      summary.meanCoverageInside += frame.coverageInside;
    }
    for (std::size_t t = 0; t < summary.tier.size(); ++t) summary.tier[t] += frame.tier[t] / double(frames.size());
  }
  summary.medianStep = quantile(steps, 0.5);
  summary.meanCoverageInside = withInside > 0 ? summary.meanCoverageInside / double(withInside) : NAN;
  if (withInside == 0) summary.leastCoverageInside = NAN;
  return summary;
}

ExitCode walk(const Options& options, const Context& context) {
  const Scene scene = loadScene(options.scene);
  const std::vector<View> views =
      options.poses.empty() ? frames(autoPath(scene, options.autoFrames, options.size.width, options.size.height))
                            : readViews(options.poses, options.size, context.log());
  const UnionOfViews photographs(scene);
  SceneRenderer renderer(scene, views, options.gpuScene, optionsFor(options.settings, {}), context);
  RenderSettings settings = options.settings;
  settings.alpha = AlphaContent::tier;

  std::vector<Frame> all;
  Json framesJson = Json::array();
  Image8 before, atWorst, beforeWorst;
  double worst = -1;
  PlanState state;
  {
    ProgressLine progress(context);
    for (std::size_t i = 0; i < views.size(); ++i) {
      check(progress.show({"walking", i, views.size()}), ErrorCode::cancelled, "stopped");
      const double dtSeconds = i > 0 ? views[i].time - views[i - 1].time : 0.0;
      Image8 image = renderer.render(views[i].camera, settings, state, dtSeconds).image;
      Frame& frame = all.emplace_back();
      frame.mainCell = state.mainCell;
      frame.switching = (i > 0 && all[i - 1].mainCell != frame.mainCell) || !state.former.empty();
      measureTiers(image, photographs, views[i].camera, frame);
      if (i > 0) frame.step = difference(image, before, 0).meanAbsolute;
      if (frame.step > worst) {
        worst = frame.step;
        beforeWorst = before;
        atWorst = image;
      }
      before = std::move(image);
      framesJson.push_back({{"name", views[i].name},
                            {"mainCell", frame.mainCell},
                            {"switching", frame.switching},
                            {"step", frame.step},
                            {"coverage", frame.coverage},
                            {"coverageInside", frame.coverageInside},
                            {"coverageTier", frame.tier}});
    }
    progress.show({"walking", views.size(), views.size()});
  }
  if (!options.output.empty() && worst >= 0) {
    fs::create_directories(options.output);
    const Image8 a = rgb(beforeWorst), b = rgb(atWorst);
    writeImage(fs::path(options.output) / "largest_step.png",
               sideBySide({a, b, absoluteDifference(a, b, kDifferenceGain)}));
  }

  const Summary summary = summaryOf(all);
  Table table;
  table.row({"frames", std::to_string(all.size())});
  table.row({"switches of the main cell", std::to_string(summary.switches)});
  table.row({"median step, levels", numberText(summary.medianStep, 3)});
  table.row({"largest step", numberText(summary.largestStep, 3)});
  table.row({"largest step at a switch", numberText(summary.largestStepAtSwitch, 3)});
  table.row({"  / median", numberText(summary.largestStepAtSwitch / summary.medianStep, 2)});
  table.row({"least coverage", numberText(summary.leastCoverage, 4)});
  table.row({"least coverage where photographs see", numberText(summary.leastCoverageInside, 4)});
  table.row({"mean coverage where photographs see", numberText(summary.meanCoverageInside, 4)});
  for (int t = 0; t < kTierCount; ++t)
    table.row({"tier " + std::to_string(t) + ", share", numberText(summary.tier[std::size_t(t)], 4)});
  context.print("{}", table.text());
  context.report(Json{{"frames", framesJson},
                      {"switches", summary.switches},
                      {"medianStep", summary.medianStep},
                      {"largestStep", summary.largestStep},
                      {"largestStepAtSwitch", summary.largestStepAtSwitch},
                      {"leastCoverage", summary.leastCoverage},
                      {"leastCoverageInside", summary.leastCoverageInside},
                      {"meanCoverageInside", summary.meanCoverageInside},
                      {"coverageTier", summary.tier},
                      {"device", renderer.deviceName()},
                      {"settings", settingsJson(settings, options.gpuScene)},
                      {"scene", options.scene}}
                     .dump(2, ' ', false, Json::error_handler_t::replace));
  return kExitOk;
}

}  // namespace

const Command kWalkCommand{
    .name = "walk",
    .summary = "Measures how steady and how whole the pictures of a walk are",
    .examples =
        "ibr walk scene\n"
        "ibr walk scene --frames 600 --size 640x360 -o worst\n"
        "ibr walk scene --poses path.json --json walk.json",
    .details =
        "A step is the mean absolute difference between neighbouring frames, in levels of 255. A switch lasts until "
        "the\n"
        "mixture of the two orders of cells is over. What photographs see: pixels whose rays lie in the picture of "
        "one\n"
        "photograph from a near distance (a tenth of the scene's points are nearer) to infinity. -o writes the two\n"
        "frames of the largest step, and four times their difference.",
    .afterInterrupt = "Nothing was reported; run the same command again.",
    .declare = [](CLI::App& app) -> std::function<ExitCode(const Context&)> {
      const auto options = std::make_shared<Options>();
      app.add_option("SCENE", options->scene, "Scene folder")->required();
      auto* frames = addInt(app, "--frames", options->autoFrames, 2, 1'000'000,
                            "Frames of an automatic walk between and slightly beyond the photographs, 30 a second");
      app.add_option("--poses", options->poses, "Camera path to walk")->type_name("FILE")->excludes(frames);
      app.add_option("-o,--output", options->output, "Folder for the picture of the largest step")->type_name("DIR");
      addSize(app, "--size", options->size, "Size of the pictures [that of the path; else of the photographs]");
      declareSettings(app, options->settings);
      declareGpuScene(app, options->gpuScene);
      return [options](const Context& context) { return walk(*options, context); };
    }};

}  // namespace ibr::app
