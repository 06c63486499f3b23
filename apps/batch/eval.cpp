// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/check.h"
#include "batch/colour_scores.h"
#include "batch/command.h"
#include "batch/options.h"
#include "batch/pictures.h"
#include "batch/poses.h"
#include "batch/progress.h"
#include "batch/scene_renderer.h"
#include "batch/settings.h"
#include "batch/table.h"
#include "batch/truth.h"
#include "ibr/metrics.h"
#include "io/image_file.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kDifferenceGain = 4;

struct Options {
  std::string scene, truth, output;
  std::vector<std::string> views;
  bool leaveOneOut = false, seams = false;
  RenderSettings settings;
  GpuSceneOptions gpuScene;
};

struct Scores {
  double psnr, ssim, flip, coverage, coverageTier0, coverageTier1, coverageTier2, psnrCovered, ssimCovered, seam,
      deltaE, milliseconds;
};

struct Figure {
  const char* name;  // in JSON
  const char* heading;
  int decimals;
  double Scores::*value;
};
constexpr Figure kFigures[] = {{"psnr", "PSNR", 2, &Scores::psnr},
                               {"ssim", "SSIM", 4, &Scores::ssim},
                               {"flip", "FLIP", 4, &Scores::flip},
                               {"coverage", "coverage", 3, &Scores::coverage},
                               {"coverageTier0", "tier 0", 3, &Scores::coverageTier0},
                               {"coverageTier1", nullptr, 3, &Scores::coverageTier1},
                               {"coverageTier2", nullptr, 3, &Scores::coverageTier2},
                               {"psnrCovered", "PSNR covered", 2, &Scores::psnrCovered},
                               {"ssimCovered", "SSIM covered", 4, &Scores::ssimCovered},
                               {"seam", nullptr, 3, &Scores::seam},
                               {"deltaE", nullptr, 3, &Scores::deltaE},
                               {"milliseconds", "ms", 1, &Scores::milliseconds}};

// `prediction` has alpha of AlphaContent::tier; its holes are black.
Scores score(const SceneRenderer::Picture& prediction, const Image8& truth) {
  const Image8& image = prediction.image;
  Image8 mask(image.width, image.height, 1);
  std::size_t covered = 0;
  for (std::size_t i = 0; i < mask.values.size(); ++i) {
    const std::uint8_t alpha = image.values[4 * i + 3];
    mask.values[i] = alpha > 0;
    covered += alpha > 0;
  }
  const double pixels = double(mask.values.size());
  const std::array<double, 4> tiers = tierShares(image);
  return {.psnr = psnr(image, truth),
          .ssim = ssim(image, truth),
          .flip = flip(image, truth),
          .coverage = double(covered) / pixels,
          .coverageTier0 = tiers[kTierAgrees],
          .coverageTier1 = tiers[kTierRejected],
          .coverageTier2 = tiers[kTierBackdrop],
          .psnrCovered = psnr(image, truth, mask),
          .ssimCovered = ssim(image, truth, mask),
          .seam = prediction.buffers ? seamStep(image, prediction.buffers->surface, truth) : std::nan(""),
          .deltaE = prediction.buffers ? gainFreeDeltaE(image, truth, mask) : std::nan(""),
          .milliseconds = prediction.milliseconds};
}

Json scoresJson(const Scores& scores) {
  Json json = Json::object();
  for (const Figure& figure : kFigures) json[figure.name] = scores.*figure.value;
  return json;
}

std::vector<std::string> scoresRow(const std::string& name, const Scores& scores) {
  std::vector<std::string> row{name};
  for (const Figure& figure : kFigures)
    if (figure.heading) row.push_back(numberText(scores.*figure.value, figure.decimals));
  return row;
}

// Over the views that have the figure: a view without cover has no psnrCovered.
Scores mean(const std::vector<Scores>& all) {
  Scores result{};
  for (const Figure& figure : kFigures) {
    double sum = 0;
    std::size_t count = 0;
    for (const Scores& scores : all)
      if (!std::isnan(scores.*figure.value)) {
        sum += scores.*figure.value;
        ++count;
      }
    result.*figure.value = count > 0 ? sum / double(count) : std::nan("");
  }
  return result;
}

ExitCode evaluate(const Options& options, const Context& context) {
  check(!options.leaveOneOut, ErrorCode::unsupported,
        "--leave-one-out is not there yet; build with --exclude and give the photographs as --truth with --views");
  const Scene scene = loadScene(options.scene);
  const Truth truth(options.truth, options.views, context.log());
  const std::vector<View>& views = truth.views();
  if (!options.output.empty()) {
    checkNamesDiffer(views);
    for (const View& view : views) pictureFile(options.output, view.name);
  }
  RendererOptions prepared = optionsFor(options.settings, {});
  if (options.seams) prepared.buffers = &scene;
  SceneRenderer renderer(scene, views, options.gpuScene, prepared, context);
  RenderSettings settings = options.settings;
  settings.alpha = AlphaContent::tier;
  settings.background = glm::vec3(0.0f);

  std::vector<Scores> all;
  Json viewsJson = Json::array();
  Table table;
  std::vector<std::string> heading{"view"};
  for (const Figure& figure : kFigures)
    if (figure.heading) heading.push_back(figure.heading);
  table.row(heading);
  {
    ProgressLine progress(context);
    for (std::size_t i = 0; i < views.size(); ++i) {
      check(progress.show({"evaluating", i, views.size()}), ErrorCode::cancelled, "stopped");
      const Image8 photograph = truth.picture(views[i]);
      PlanState alone;
      // A driver compiles on first use: the first picture is made twice, and the second is timed.
      if (i == 0) renderer.render(views[i].camera, settings, alone);
      alone = {};
      const auto prediction = renderer.render(views[i].camera, settings, alone);
      all.push_back(score(prediction, photograph));
      table.row(scoresRow(views[i].name, all.back()));
      Json view{{"name", views[i].name}};
      view.update(scoresJson(all.back()));
      viewsJson.push_back(std::move(view));
      if (options.output.empty()) continue;
      const fs::path file = pictureFile(options.output, views[i].name);
      fs::create_directories(file.parent_path());
      const Image8 shown = rgb(prediction.image);
      writeImage(file, sideBySide({shown, photograph, absoluteDifference(shown, photograph, kDifferenceGain)}));
    }
    progress.show({"evaluating", views.size(), views.size()});
  }
  const Scores means = mean(all);
  table.row(scoresRow("mean", means));
  context.print("{}", table.text());
  if (options.seams)
    context.print("seams {} levels, colours ΔE {}\n", numberText(means.seam, 3), numberText(means.deltaE, 3));
  context.report(Json{{"views", viewsJson},
                      {"mean", scoresJson(means)},
                      {"device", renderer.deviceName()},
                      {"settings", settingsJson(settings, options.gpuScene)},
                      {"scene", options.scene}}
                     .dump(2, ' ', false, Json::error_handler_t::replace));
  return kExitOk;
}

}  // namespace

const Command kEvalCommand{
    .name = "eval",
    .summary = "Compares rendered views with photographs that were held out",
    .examples =
        "ibr eval scene --truth held-out\n"
        "ibr eval scene --truth photographs --views IMG_0007.jpg IMG_0015.jpg -o compared\n"
        "ibr eval scene --truth held-out --cells 1 --tiers 0 --json -",
    .details =
        "DIR has images/ and a COLMAP model in sparse/ (or both in DIR). PSNR is on 8-bit values; holes count as black "
        "in "
        "PSNR, SSIM and FLIP and are left out of the 'covered' columns. -o writes prediction, truth and four times the "
        "difference "
        "side by side. ms is the time from planning until the picture is on the host. In JSON, PSNR is null where "
        "nothing is "
        "covered and where pictures are equal.",
    .afterInterrupt = "Nothing was reported; run the same command again.",
    .declare = [](CLI::App& app) -> std::function<ExitCode(const Context&)> {
      const auto options = std::make_shared<Options>();
      app.add_option("SCENE", options->scene, "Scene folder")->required();
      auto* truth =
          app.add_option("--truth", options->truth, "Held-out photographs with their poses")->type_name("DIR");
      app.add_option("--views", options->views, "Only these views, by name")->type_name("NAME...");
      app.add_option("-o,--output", options->output, "Folder for prediction, truth and difference")->type_name("DIR");
      // Accepted so that the answer can be a sentence; hidden until it works.
      auto* leaveOneOut = app.add_flag("--leave-one-out", options->leaveOneOut)->group("");
      truth->excludes(leaveOneOut);
      app.add_flag("--seams", options->seams,
                   "Also the step in colour from cell to cell beyond the truth's, in levels, and the colour difference "
                   "(CIE 1976) that the best gain of each channel leaves");
      declareSettings(app, options->settings);
      declareGpuScene(app, options->gpuScene);
      app.callback([options] {
        if (options->truth.empty() && !options->leaveOneOut) throw CLI::RequiredError("--truth");
      });
      return [options](const Context& context) { return evaluate(*options, context); };
    }};

}  // namespace ibr::app
