// SPDX-License-Identifier: Apache-2.0
// Frame and pass times, ours and the paper's side by side, of a scene or of generated ones shaped like [T] table 2.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/check.h"
#include "batch/bench/bench_matchers.h"
#include "batch/bench/bench_photographs.h"
#include "batch/bench/frame_bench.h"
#include "batch/command.h"
#include "batch/files/poses.h"
#include "scene/synth/bench_scene.h"
#include "shared/camera/auto_path.h"
#include "shared/cli/options.h"
#include "shared/cli/progress.h"
#include "shared/cli/settings.h"
#include "shared/draw/scene_renderer.h"
#include "shared/report/statistics.h"
#include "shared/report/table.h"

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string scene;
  std::vector<const BenchShape*> generated;
  double detail = 1;  // of generated photographs
  PictureSize size;
  std::vector<int> cells{1, 5, 12};
  int views = 3;
  BenchCase wanted;
  GpuSceneOptions gpuScene;
  bool formats = false;
  std::string walk;  // camera path
  MatcherBench matchers;
};

struct Report {
  Table table;
  Json frames = Json::array(), passes = Json::array();
};

Json number(double value) {
  return std::isnan(value) ? Json(nullptr) : Json(value);
}

void add(Report& report, const std::string& scene, const RenderSettings& settings, const BenchResult& result) {
  for (const WayTimes& times : result.ways) {
    const BenchWay& way = times.way;
    const double median = quantile(times.milliseconds, 0.5), p95 = quantile(times.milliseconds, 0.95);
    const double toPaper = quantile(times.toPaper, 0.5), toUnmapped = quantile(times.toUnmapped, 0.5);
    const double toTwoMono = quantile(times.toTwoMono, 0.5), toWhole = quantile(times.toWhole, 0.5);
    const Json which{{"scene", scene},
                     {"cells", settings.maxCells},
                     {"drawn", result.drawn},
                     {"triangles", result.triangles},
                     {"way", way.name},
                     {"composition", wordOf(compositionOf(way, settings))},
                     {"colourMapping", wordOf(way.colour)},
                     {"blend", wordOf(way.blend)},
                     {"views", way.views},
                     {"hiddenCorners", way.hidden}};
    Json frame = which;
    frame.update({{"medianMs", median},
                  {"p95Ms", p95},
                  {"n", times.milliseconds.size()},
                  {"ratioToPaper", number(toPaper)},
                  {"ratioToUnmapped", number(toUnmapped)},
                  {"ratioToTwoMono", number(toTwoMono)},
                  {"ratioToWhole", number(toWhole)}});
    report.frames.push_back(frame);
    for (const auto& [name, milliseconds] : times.passes) {
      Json pass = which;
      pass.update({{"pass", name},
                   {"medianMs", quantile(milliseconds, 0.5)},
                   {"p95Ms", quantile(milliseconds, 0.95)},
                   {"n", milliseconds.size()}});
      report.passes.push_back(pass);
    }
    report.table.row({scene, std::to_string(settings.maxCells), std::to_string(result.drawn),
                      std::to_string(result.triangles), way.name, wordOf(way.colour), wordOf(way.blend),
                      std::to_string(way.views), numberText(median, 1), numberText(p95, 1), numberText(toPaper, 3),
                      numberText(toUnmapped, 3), numberText(toTwoMono, 3), numberText(toWhole, 3)});
  }
}

ExitCode bench(const Options& options, const Context& context) {
  Device device = Device::create({.device = context.options().device, .log = context.log()});
  Report report;
  report.table.row({"scene", "cells", "drawn", "triangles", "way", "colour", "blend", "views", "median ms", "p95 ms",
                    "/ paper", "/ unmapped", "/ two", "/ whole"});
  ProgressLine progress(context);
  const std::size_t total = options.generated.empty() ? options.cells.size() : options.generated.size();
  std::size_t done = 0;
  const auto step = [&] { check(progress.show({"measuring", done, total}), ErrorCode::cancelled, "stopped"); };
  const auto measure = [&](const FrameBench& bench, const std::string& scene, int cells) {
    BenchCase wanted = options.wanted;
    wanted.settings.maxCells = std::uint32_t(cells);
    add(report, scene, wanted.settings, bench.measure(wanted, step));
    ++done;
  };
  if (options.generated.empty()) {
    BenchSubject subject{options.scene, loadScene(options.scene), withLog(options.gpuScene, context), {}};
    for (const View& view : frames(autoPath(subject.scene, options.views, options.size.width, options.size.height)))
      subject.views.push_back(view.camera);
    const FrameBench bench(device, subject, options.wanted);
    for (const int cells : options.cells) measure(bench, options.scene, cells);
  }
  for (const BenchShape* shape : options.generated) {
    step();
    GpuSceneOptions gpuScene = withLog(options.gpuScene, context);
    gpuScene.source = [](const Scene& scene, std::size_t node, int firstLevel) {
      return smallerLevels(benchPhotograph(scene, node), firstLevel);
    };
    const BenchSubject subject{shape->name, makeBenchScene(*shape, options.detail), gpuScene,
                               benchViews(*shape, options.views, options.size.width, options.size.height)};
    measure(FrameBench(device, subject, options.wanted), shape->name, shape->cells);
  }
  progress.show({"measuring", total, total});
  context.print("{}", report.table.text());
  const bool software = device.kind() == DeviceKind::software;
  context.report(
      Json{{"device", device.name()},
           {"size", {options.size.width, options.size.height}},
           {"frames", report.frames},
           {"passes", report.passes},
           {"passTimes", software ? "timestamps inside one submission of a software device: they add up to the frame's"
                                  : "device timestamps"},
           {"settings", settingsJson(options.wanted.settings, options.gpuScene)},
           {"scene", options.scene}}
          .dump(2, ' ', false, Json::error_handler_t::replace));
  return kExitOk;
}

CLI::Option* declareGenerated(CLI::App& app, Options& options, CLI::Option* scene) {
  std::string names;
  for (const BenchShape& shape : benchShapes()) names += (names.empty() ? "" : ", ") + std::string(shape.name);
  CLI::Option* generated = app.add_option_function<std::vector<std::string>>(
      "--generated",
      [&options](const std::vector<std::string>& wanted) {
        for (const std::string& name : wanted) {
          const BenchShape* shape = findBenchShape(name);
          if (!shape && name != "all")
            throw CLI::ValidationError("--generated", "'" + name + "' is none of the generated scenes");
          for (const BenchShape& each : benchShapes())
            if (shape == &each || name == "all") options.generated.push_back(&each);
        }
      },
      "Measure generated scenes with all of their cells: all, or of " + names);
  generated->delimiter(',')->type_name("NAME,…")->excludes(scene);
  addDouble(app, "--generated-detail", options.detail, 0.01, 1,
            "Sides of generated photographs, in those of 1280x960 (panoramas: 2048x1024)");
  return generated;
}

ExitCode benchPhotographs(const Options& options, const Context& context) {
  const Scene scene = loadScene(options.scene);
  const std::vector<View> views = options.walk.empty()
                                      ? frames(autoPath(scene, options.views, options.size.width, options.size.height))
                                      : readViews(options.walk, options.size, context.log());
  const auto sizeOf = [](const View& view) {
    return std::pair(view.camera.intrinsics.width, view.camera.intrinsics.height);
  };
  for (const View& view : views)
    check(sizeOf(view) == sizeOf(views[0]), ErrorCode::invalidInput, "{}: {} and {} differ in size; give one by --size",
          options.walk, views[0].name, view.name);
  const PhotographBench bench{scene, views, options.wanted.settings, options.gpuScene, options.wanted.repeat};
  Json report = options.walk.empty() ? benchFormats(bench, context) : benchWalk(bench, context);
  report["size"] = sizeOf(views[0]);
  report["settings"] = settingsJson(options.wanted.settings, options.gpuScene);
  report["scene"] = options.scene;
  context.report(report.dump(2, ' ', false, Json::error_handler_t::replace));
  return kExitOk;
}

}  // namespace

const Command kBenchCommand{
    .name = "bench",
    .summary = "Measures frame times of a scene, ours against the paper's, without and with colour mapping",
    .examples =
        "ibr bench scene\n"
        "ibr bench scene --size 1280x720 --cells 1,4,16 --repeat 15 --json times.json\n"
        "ibr bench --generated stitched-12,stacked-12 --stereo --json -\n"
        "ibr bench scene --formats\n"
        "ibr bench scene --walk path.json --vram-budget 1G\n"
        "ibr bench --matchers cases.json --data photographs --pictures compared",
    .details =
        "Times are the device's, for one frame without the way back to the host. All settings but the order, colour\n"
        "mapping and blending are the same for all; the paper's way draws cells, whatever --composition says.\n"
        "\"/ paper\" compares with the paper's order without colour mapping, \"/ unmapped\" with the same order\n"
        "without it, \"/ two\" two views with twice one view, \"/ whole\" two views without the corners that a\n"
        "headset's lenses hide, 18 % of the pixels, with two whole ones. \"drawn\" is how many cells were in view at\n"
        "most. Colour tables of ours are made in one frame of a few: its time is the mean over these.\n"
        "--formats compares formats of textures and filters instead, in time, memory and picture, against rgba8 with\n"
        "trilinear filters. --walk goes along a camera path as a viewer does: each frame shows what is there.\n"
        "--matchers compares the methods of matching on pairs and cells: FILE lists {\"name\", \"images\"} under\n"
        "\"cases\", with \"model\", \"maxSize\", and \"disparity\", \"homography\" or \"depth\" and \"depthUnit\" if "
        "known.\n"
        "Errors are those of the vertices of blended triangles; member dB says how alike members are there, exposure "
        "apart.",
    .afterInterrupt = "Nothing was written.",
    .declare = [](CLI::App& app) -> std::function<ExitCode(const Context&)> {
      const auto options = std::make_shared<Options>();
      CLI::Option* scene = app.add_option("SCENE", options->scene, "Scene folder");
      CLI::Option* generated = declareGenerated(app, *options, scene);
      addSize(app, "--size", options->size, "Size of the pictures [1920x1080; that of the path]");
      app.add_option("--cells", options->cells, "Numbers of cells to measure of SCENE [1,5,12]")
          ->delimiter(',')
          ->check(CLI::Range(1, int(kLargestCellCount)))
          ->type_name("N,…");
      addInt(app, "--views", options->views, 1, 1000, "Views to measure, along an automatic path");
      addInt(app, "--repeat", options->wanted.repeat, 1, 10'000, "Frames of each way and view");
      auto* stereo = app.add_flag("--stereo", options->wanted.stereo, "Also measure two views, 64 mm apart");
      RenderSettings defaults;  // whose cells are compared
      defaults.lowestTier = kTierFilled;
      declarePictureSettings(app, options->wanted.settings, defaults);
      declareGpuScene(app, options->gpuScene);
      auto* formats = app.add_flag("--formats", options->formats, "Measure formats of textures and filters");
      auto* walk = app.add_option("--walk", options->walk, "Walk along a camera path (see render), and measure memory")
                       ->type_name("FILE")
                       ->excludes(formats);
      auto* matchers = app.add_option("--matchers", options->matchers.cases, "Compare methods of matching instead")
                           ->type_name("FILE")
                           ->excludes(scene)
                           ->excludes(generated)
                           ->excludes(formats)
                           ->excludes(walk);
      app.add_option("--data", options->matchers.data, "Folder that paths in FILE start from [that of FILE]")
          ->type_name("DIR")
          ->needs(matchers);
      app.add_option("--pictures", options->matchers.pictures, "Write what each method makes of the members")
          ->type_name("DIR")
          ->needs(matchers);
      for (CLI::Option* other : {generated, stereo}) other->excludes(formats)->excludes(walk);
      app.callback([options] {
        if (options->scene.empty() && options->generated.empty() && options->matchers.cases.empty())
          throw CLI::RequiredError("SCENE, --generated or --matchers");
      });
      return [options](const Context& context) {
        if (!options->matchers.cases.empty()) {
          context.report(benchMatchers(options->matchers, context).dump(2, ' ', false, Json::error_handler_t::replace));
          return kExitOk;
        }
        if (options->size.width == 0 && options->walk.empty()) options->size = {1920, 1080};
        const bool photographs = options->formats || !options->walk.empty();
        return photographs ? benchPhotographs(*options, context) : bench(*options, context);
      };
    }};

}  // namespace ibr::app
