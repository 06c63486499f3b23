// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <glm/trigonometric.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>

#include "base/check.h"
#include "batch/command.h"
#include "batch/files/poses.h"
#include "batch/htm/htm_render_views.h"
#include "ibr/error.h"
#include "ibr/view_scores.h"
#include "io/exr.h"
#include "shared/camera/auto_path.h"
#include "shared/camera/up.h"
#include "shared/cli/options.h"
#include "shared/cli/presets.h"
#include "shared/cli/progress.h"
#include "shared/cli/settings.h"
#include "shared/cli/signals.h"
#include "shared/draw/image_operations.h"
#include "shared/draw/picture_record.h"
#include "shared/draw/scene_renderer.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

struct Options : RenderedViews {
  std::string scene;
  bool stereo = false;
  double ipd = 0;  // 0: not given
  bool buffers = false;
  std::optional<double> floor, floorSpacing;  // FloorOptions
  RenderSettings settings;
  GpuSceneOptions gpuScene;
  HtmViewsOptions htm;  // options for harmonised models only
};

void declareSceneOptions(CLI::App& app, Options& options) {
  const auto number = [&app](const char* name, double& value, double low, double high, const char* description) {
    return addParsed(
        app, name, [name, &value, low, high](const std::string& text) { value = parsedDouble(name, text, low, high); },
        description);
  };
  const Option stereo = addFlag(app, "--stereo", options.stereo, "Render an image for each eye, NAME_l and NAME_r");
  number("--ipd", options.ipd, 1e-9, 1e9, "Distance between the eyes in world units, metres for metric poses")
      .type("METRES")
      .needs(stereo);
  addFlag(app, "--buffers", options.buffers, "Also write depth, tier, rank, weights and confidence, as NAME.exr");
  const auto given = [&app](const char* name, std::optional<double>& value, double low, const char* description) {
    return addParsed(
               app, name, [name, &value, low](const std::string& text) { value = parsedDouble(name, text, low, 1e9); },
               description)
        .type("METRES");
  };
  const Option floor =
      given("--floor", options.floor, -1e9,
            "Distance of a grid below the photographs, in world units; the grid is drawn where no photograph "
            "shows anything");
  given("--floor-spacing", options.floorSpacing, 1e-9, "Distance between grid lines, in world units [half of --floor]")
      .needs(floor);
  declareSettings(app, options.settings);  // includes --preset, which must precede all other settings
  declareOverlays(app, options.settings);
  declareGpuScene(app, options.gpuScene);
}

bool isHarmonised(std::optional<AssetKind> kind) {
  return kind == AssetKind::htmModel || kind == AssetKind::htmSequence;
}

ExitCode renderHarmonised(const Options& options, const Context& context) {
  HtmViewsOptions htm = options.htm;
  htm.model = options.scene;
  static_cast<RenderedViews&>(htm) = options;
  return renderHtmViews(htm, context);
}

ExitCode renderViews(const Options& options, const Context& context) {
  if (isHarmonised(assetKind(options.scene))) return renderHarmonised(options, context);
  const Scene scene = loadScene(options.scene);
  checkCells(options.settings, scene);
  RenderSettings settings = options.settings;
  std::optional<FloorOptions> floor;
  if (options.floor) floor = FloorOptions{*options.floor, options.floorSpacing};
  if (floor) settings.floor = floorBelow(scene, *floor);
  const bool isPath = options.poses.empty() || isWalk(options.poses);
  std::vector<View> asked = options.autoFrames > 0
                                ? frames(autoPath(scene, options.autoFrames, options.size.width, options.size.height))
                                : readViews(options.poses, options.size, context.log(), options.stereo);
  if (options.fovDegrees > 0) setFov(asked, glm::radians(options.fovDegrees));
  const std::vector<Frame> frames = framesOf(asked, options.stereo, options.ipd);
  std::vector<View> views;
  for (const Frame& frame : frames) views.insert(views.end(), frame.begin(), frame.end());
  checkNamesDiffer(views);
  for (const View& view : views) pictureFile(options.output, view.name);  // checks all names before anything is written

  context.logMessage(LogLevel::info, "settings: {}", presetText(settings));
  RendererOptions wanted = optionsFor(settings, {});
  wanted.maxViews = options.stereo ? 2 : 1;
  wanted.uncertaintyScene = &scene;
  if (options.buffers) wanted.bufferScene = &scene;
  SceneRenderer renderer(scene, views, options.gpuScene, wanted, context);
  if (options.graph) renderer.showGraph();
  settings.alpha = AlphaContent::tier;
  Json drawn = pictureSettingsJson(settings, options.gpuScene, floor);
  drawn["graph"] = options.graph;
  Json written = Json::array();
  double least = 1, sum = 0;
  PlanState walk;
  {
    ProgressLine progress(context);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      check(progress.show({"rendering", i, frames.size()}), ErrorCode::cancelled, "stopped");
      if (!isPath) walk = {};
      const double dtSeconds = i > 0 ? frames[i][0].time - frames[i - 1][0].time : 0.0;
      std::vector<Camera> eyes;
      for (const View& view : frames[i]) eyes.push_back(view.camera);
      const auto pictures = renderer.render(eyes, settings, walk, dtSeconds);
      for (std::size_t eye = 0; eye < eyes.size(); ++eye) {
        const std::string& name = frames[i][eye].name;
        const fs::path file = pictureFile(options.output, name);
        fs::create_directories(file.parent_path());
        writePicture(file, rgb(pictures[eye].image), {eyes[eye], std::nullopt, drawn});
        const std::array<double, 4> tiers = tierShares(pictures[eye].image);
        const double coverage = std::accumulate(tiers.begin(), tiers.end(), 0.0);
        least = std::min(least, coverage);
        sum += coverage;
        Json entry{{"name", name},
                   {"file", file.string()},
                   {"coverage", coverage},
                   {"tiers", tiers},
                   {"milliseconds", pictures[eye].milliseconds}};
        if (pictures[eye].buffers) {
          const fs::path known = fs::path(file).replace_extension(".exr");
          writeExr(known, exrChannels(pictures[eye].image, *pictures[eye].buffers));
          entry["buffers"] = known.string();
        }
        written.push_back(std::move(entry));
      }
    }
    progress.show({"rendering", frames.size(), frames.size()});
  }
  context.print("{} images in {}; mean coverage {:.4f}, minimum {:.4f}\n", views.size(), options.output,
                sum / double(views.size()), least);
  Json reported = drawn;
  reported["fov"] = options.fovDegrees > 0 ? Json(options.fovDegrees) : Json();
  reported["ipd"] = options.ipd > 0 ? Json(options.ipd) : Json();
  context.report(
      Json{{"views", written}, {"device", renderer.deviceName()}, {"settings", reported}, {"scene", options.scene}});
  return kExitOk;
}

}  // namespace

const Command kRenderCommand{
    .name = "render",
    .summary = "Renders new views of a scene, a harmonised model or 3D video as PNG files",
    .examples =
        "ibr render scene --path auto:90 -o pictures\n"
        "ibr render scene --poses held-out/sparse -o pictures\n"
        "ibr render scene --poses path.json --size 1280x720 -o pictures\n"
        "ibr render scene --poses screenshot.png --preset accurate -o pictures\n"
        "ibr render scene --poses screenshot_l.png --stereo -o pictures\n"
        "ibr render scene --path auto:90 --stereo --ipd 0.063 -o pictures\n"
        "ibr render model --path auto:90 -o pictures",
    .details =
        "--poses takes poses in any format of ibr build --model, or a camera path:\n"
        "  {\"version\":1,\"size\":[w,h],\"fps\":30,\"keys\":[{\"time\":s,\"position\":[x,y,z],\n"
        "   \"rotation\":[x,y,z,w],\"fovY\":radians},…]}\n"
        "Cameras look along -z, y up. Images are named after the poses.\n"
        "--poses also takes an image that ibr or its viewer has written. Such PNG files store\n"
        "their view and their settings (ibr info PICTURE.png). Only the view is used; settings\n"
        "come from this command.\n"
        "--stereo renders two images per pose, NAME_l and NAME_r, with the same draw order and\n"
        "colour table. Poses that already have such names are used as eyes, each with its own\n"
        "principal point and direction. An image NAME_l.png or NAME_r.png stands for both eyes;\n"
        "the other eye's image is in the same folder.\n"
        "--buffers writes NAME.exr beside each image, with these channels:\n"
        "R, G, B: linear\n"
        "Z: depth along the viewing axis, world units, infinite where unknown\n"
        "tier\n"
        "rank: 0 is the main cell\n"
        "weight.0 to weight.3: weights of the members' colours\n"
        "confidence.spread: standard deviation of the members' colours\n"
        "confidence.uncertainty: of the inverse depth, 1/world unit\n"
        "confidence.extrapolation: distance to the cell, world units\n"
        "During a cross-fade, the channels are those of the new draw order.\n"
        "Harmonised models and 3D video are drawn as ibr htm render does (ibr htm render --help).",
    .afterInterrupt = "written images are complete; the same command writes all images again",
    .mainOptions = "poses path output size fov preset stereo buffers overlay json",
    .declare = [](CLI::App& app) -> std::function<ExitCode(const Context&)> {
      const auto options = std::make_shared<Options>();
      addOption(app, "SCENE", options->scene, "Folder of a scene, of a harmonised model or of 3D video").required();
      declareRenderedViews(app, *options);
      const auto ofScenes = inGroup(app, "Scenes", [&] { declareSceneOptions(app, *options); });
      const auto ofModels = inGroup(app, "Harmonised models, 3D video", [&] { declareHtmViews(app, options->htm); });
      afterParsing(app, [options, ofScenes, ofModels] {
        options->htm.model = options->scene;
        const std::optional<AssetKind> kind = assetKind(options->scene);
        if (kind == AssetKind::scene)
          refuseIfSet(ofModels, "is for harmonised models, but " + options->scene + " is a scene");
        if (isHarmonised(kind)) {
          refuseIfSet(ofScenes, "is for scenes, but " + options->scene + " is a harmonised model or 3D video");
          checkHtmViews(options->htm, kind);
        }
        requireViews(*options);
      });
      return [options](const Context& context) { return renderViews(*options, context); };
    }};

}  // namespace ibr::app
