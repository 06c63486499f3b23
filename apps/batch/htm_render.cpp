// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/check.h"
#include "batch/htm.h"
#include "batch/htm_renderer.h"
#include "batch/options.h"
#include "batch/poses.h"
#include "batch/progress.h"
#include "batch/statistics.h"
#include "ibr/error.h"
#include "io/image_file.h"
#include "shared/auto_path.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string model, poses, output;
  int autoFrames = 0;  // 0: not asked for
  PictureSize size;
  bool onSource = false;
  HtmSettings settings;
};

std::vector<View> viewsOf(const HtmModel& model, const Options& options, const Context& context) {
  if (options.autoFrames == 0) return readViews(options.poses, options.size, context.log());
  Scene scene;  // of the photographs' places alone
  for (const HtmCamera& camera : model.cameras) scene.nodes.push_back({camera.name, camera.camera, {}, {}});
  return frames(autoPath(scene, options.autoFrames, options.size.width, options.size.height));
}

double coverageOf(const Image8& picture) {
  std::size_t covered = 0;
  for (std::size_t i = 3; i < picture.values.size(); i += 4) covered += picture.values[i] > 0;
  return double(covered) * 4 / double(std::max<std::size_t>(picture.values.size(), 1));
}

ExitCode renderViews(const Options& options, const Context& context) {
  HtmModel model = loadHtmModel(options.model);
  if (options.onSource) {
    check(model.source.has_value(), ErrorCode::invalidInput, "{}: the model keeps no mesh of before it was optimised",
          options.model);
    model = baselineModel(model);
  }
  const std::vector<View> views = viewsOf(model, options, context);
  checkNamesDiffer(views);
  for (const View& view : views) pictureFile(options.output, view.name);  // before anything is written
  const bool isPath = options.autoFrames > 0 || !(fs::is_directory(options.poses) || isTransforms(options.poses));

  HtmPictures pictures(model, context);
  Json written = Json::array();
  std::vector<double> coverage, weights, coordinates, rasterisation;
  HtmState walk;
  {
    ProgressLine progress(context);
    for (std::size_t i = 0; i < views.size(); ++i) {
      check(progress.show({"rendering", i, views.size()}), ErrorCode::cancelled, "stopped");
      if (!isPath) walk = {};
      const double dtSeconds = i > 0 ? views[i].time - views[i - 1].time : 0.0;
      const HtmPictures::Picture picture = pictures.render(views[i].camera, options.settings, walk, dtSeconds);
      const fs::path file = pictureFile(options.output, views[i].name);
      fs::create_directories(file.parent_path());
      writeImage(file, picture.image);
      coverage.push_back(coverageOf(picture.image));
      weights.push_back(picture.weights);
      coordinates.push_back(picture.coordinates);
      rasterisation.push_back(picture.rasterisation);
      written.push_back({{"name", views[i].name},
                         {"file", file.string()},
                         {"coverage", coverage.back()},
                         {"weightsMs", picture.weights},
                         {"coordinatesMs", picture.coordinates},
                         {"rasterisationMs", picture.rasterisation},
                         {"milliseconds", picture.milliseconds}});
    }
    progress.show({"rendering", views.size(), views.size()});
  }
  context.print(
      "{} pictures in {}; coverage {:.4f}, weights {:.3f} ms, coordinates {:.3f} ms, rasterisation {:.3f} ms\n",
      views.size(), options.output, mean(coverage), quantile(weights, 0.5), quantile(coordinates, 0.5),
      quantile(rasterisation, 0.5));
  context.report(Json{{"views", written},
                      {"device", pictures.device().name()},
                      {"settings",
                       {{"method", htmMethodName(options.settings.method)},
                        {"gamma", options.settings.gamma},
                        {"weightCut", options.settings.weightCut},
                        {"smooth", options.settings.smoothSeconds},
                        {"mesh", options.onSource ? "source" : "optimised"}}},
                      {"model", options.model}}
                     .dump(2, ' ', false, Json::error_handler_t::replace));
  return kExitOk;
}

}  // namespace

const Command kHtmRenderCommand{
    .name = "render",
    .summary = "Renders new views of a harmonised model as PNG files",
    .examples =
        "ibr htm render model --path auto:90 -o pictures\n"
        "ibr htm render model --poses held-out/sparse -o pictures\n"
        "ibr htm render model --poses path.json --size 1024x768 --method vdtbm -o pictures",
    .details =
        "--poses takes a COLMAP model's folder, transforms.json, or a camera path (ibr render --help). Pictures are\n"
        "named after the poses and transparent where the object is not.\n"
        "Methods: htm, harmonised photographs; vdtbm, photographs blended as they are; vdvbm, colours of vertices.",
    .afterInterrupt = "The pictures that are there are whole; the same command makes all of them again.",
    .declare = [](CLI::App& app) -> std::function<ExitCode(const Context&)> {
      const auto options = std::make_shared<Options>();
      app.add_option("MODEL", options->model, "Model folder")->required();
      auto* poses =
          app.add_option("--poses", options->poses, "COLMAP model's folder, transforms.json, or a camera path")
              ->type_name("FILE|DIR");
      poses->excludes(addAutoPath(app, options->autoFrames));
      app.add_option("-o,--output", options->output, "Folder for the pictures; made where it is missing")
          ->required()
          ->type_name("DIR");
      addSize(app, "--size", options->size, "Size of the pictures [that of the poses; auto: of the photographs]");
      addChoice<HtmMethod>(
          app, "--method", options->settings.method,
          {{"htm", HtmMethod::harmonised}, {"vdtbm", HtmMethod::blended}, {"vdvbm", HtmMethod::vertexColours}},
          "How colours come from photographs [htm]");
      addChoice<bool>(app, "--mesh", options->onSource, {{"optimised", false}, {"source", true}},
                      "Which mesh is drawn; the one of before has nothing to harmonise [optimised]");
      declareHtmSettings(app, options->settings);
      addDouble(app, "--smooth", options->settings.smoothSeconds, 0, 60,
                "Along a path, seconds in which weights follow the view");
      app.callback([options] {
        if (options->poses.empty() && options->autoFrames == 0) throw CLI::RequiredError("--poses or --path");
      });
      return [options](const Context& context) { return renderViews(*options, context); };
    }};

}  // namespace ibr::app
