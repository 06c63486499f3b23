// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/check.h"
#include "batch/command.h"
#include "batch/options.h"
#include "batch/pictures.h"
#include "batch/poses.h"
#include "batch/progress.h"
#include "batch/scene_renderer.h"
#include "batch/settings.h"
#include "batch/signals.h"
#include "ibr/error.h"
#include "io/image_file.h"
#include "shared/auto_path.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string scene, poses, output;
  int autoFrames = 0;  // 0: not asked for
  PictureSize size;
  RenderSettings settings;
};

ExitCode renderViews(const Options& options, const Context& context) {
  const Scene scene = loadScene(options.scene);
  const bool isPath = options.poses.empty() || !fs::is_directory(options.poses);
  const std::vector<View> views =
      options.autoFrames > 0 ? frames(autoPath(scene, options.autoFrames, options.size.width, options.size.height))
                             : readViews(options.poses, options.size, context.log());
  checkNamesDiffer(views);
  for (const View& view : views) pictureFile(options.output, view.name);  // before anything is written

  SceneRenderer renderer(scene, views, options.settings, context);
  context.say(LogLevel::info, "rendering on {}", renderer.deviceName());
  Json written = Json::array();
  PlanState walk;
  {
    ProgressLine progress(context);
    for (std::size_t i = 0; i < views.size(); ++i) {
      check(progress.show({"rendering", i, views.size()}), ErrorCode::cancelled, "stopped");
      if (!isPath) walk = {};
      const double dtSeconds = i > 0 ? views[i].time - views[i - 1].time : 0.0;
      const auto picture = renderer.render(views[i].camera, options.settings, walk, dtSeconds);
      const fs::path file = pictureFile(options.output, views[i].name);
      fs::create_directories(file.parent_path());
      writeImage(file, rgb(picture.image));
      written.push_back({{"name", views[i].name}, {"file", file.string()}, {"milliseconds", picture.milliseconds}});
    }
    progress.show({"rendering", views.size(), views.size()});
  }
  context.print("{} pictures in {}\n", views.size(), options.output);
  context.report(Json{{"views", written},
                      {"device", renderer.deviceName()},
                      {"settings", settingsJson(options.settings)},
                      {"scene", options.scene}}
                     .dump(2, ' ', false, Json::error_handler_t::replace));
  return kExitOk;
}

}  // namespace

const Command kRenderCommand{
    .name = "render",
    .summary = "Renders new views of a scene as PNG files",
    .examples =
        "ibr render scene --path auto:90 -o pictures\n"
        "ibr render scene --poses held-out/sparse -o pictures\n"
        "ibr render scene --poses path.json --size 1280x720 -o pictures",
    .details =
        "--poses takes a COLMAP model's folder or a camera path:\n"
        "  {\"version\":1,\"size\":[w,h],\"fps\":30,\"keys\":[{\"time\":s,\"position\":[x,y,z],\n"
        "   \"rotation\":[x,y,z,w],\"fovY\":radians},…]}\n"
        "with cameras that look along -z, y up. Pictures are named after the poses.",
    .afterInterrupt = "The pictures that are there are whole; the same command makes all of them again.",
    .declare = [](CLI::App& app) -> std::function<ExitCode(const Context&)> {
      const auto options = std::make_shared<Options>();
      app.add_option("SCENE", options->scene, "Scene folder")->required();
      auto* poses =
          app.add_option("--poses", options->poses, "COLMAP model's folder, or a camera path")->type_name("FILE|DIR");
      auto* path = app.add_option_function<std::string>(
                          "--path",
                          [options](const std::string& text) {
                            const std::string prefix = "auto:";
                            if (!text.starts_with(prefix))
                              throw CLI::ValidationError("--path", "'" + text + "' is not of the form auto:N");
                            options->autoFrames = int(parsedInt("--path", text.substr(prefix.size()), 1, 1'000'000));
                          },
                          "N views between and slightly beyond the photographs")
                       ->type_name("auto:N");
      poses->excludes(path);
      app.add_option("-o,--output", options->output, "Folder for the pictures; made where it is missing")
          ->required()
          ->type_name("DIR");
      addSize(app, "--size", options->size, "Size of the pictures [that of the poses; auto: of the photographs]");
      declareSettings(app, options->settings);
      app.callback([options] {
        if (options->poses.empty() && options->autoFrames == 0) throw CLI::RequiredError("--poses or --path");
      });
      return [options](const Context& context) { return renderViews(*options, context); };
    }};

}  // namespace ibr::app
