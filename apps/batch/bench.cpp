// SPDX-License-Identifier: Apache-2.0
// Frame times, ours and the paper's side by side, each without and with colour mapping. They are measured in turn,
// frame by frame, so that a machine whose speed drifts does not favour one; a ratio is the median of the pairs' ratios.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/check.h"
#include "batch/bench_photographs.h"
#include "batch/command.h"
#include "batch/options.h"
#include "batch/poses.h"
#include "batch/progress.h"
#include "batch/scene_renderer.h"
#include "batch/settings.h"
#include "batch/statistics.h"
#include "batch/table.h"
#include "gpu/scope.h"
#include "ibr/offscreen.h"
#include "shared/auto_path.h"

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string scene;
  PictureSize size;
  std::vector<int> cells{1, 5, 12};
  int views = 3;
  int repeat = 9;
  RenderSettings settings;
  GpuSceneOptions gpuScene;
  bool formats = false;
  std::string walk;  // camera path
};

struct Way {
  const char* name;
  DrawOrder order;
  ColourMapping colour;
  std::size_t unmapped;  // the same way without colour mapping
};
constexpr std::array kWays{Way{"paper", DrawOrder::paper, ColourMapping::off, 0},
                           Way{"ours", DrawOrder::ours, ColourMapping::off, 1},
                           Way{"paper", DrawOrder::paper, ColourMapping::paper, 0},
                           Way{"paper", DrawOrder::paper, ColourMapping::paperRedraw, 0},
                           Way{"ours", DrawOrder::ours, ColourMapping::ours, 1}};

std::size_t triangleCount(const Scene& scene, const FramePlan& plan) {
  std::size_t count = 0;
  for (const PlannedCell& cell : plan.cells)
    count += plan.settings.lowestTier == kTierAgrees ? scene.cells[cell.cell].mesh.tier0Count()
                                                     : scene.cells[cell.cell].mesh.triangles.size();
  return count;
}

ExitCode bench(const Options& options, const Context& context) {
  const Scene scene = loadScene(options.scene);
  const SceneBounds bounds = sceneBounds(scene);
  const std::vector<View> views = frames(autoPath(scene, options.views, options.size.width, options.size.height));
  Device device = Device::create({.device = context.options().device, .log = context.log()});
  const VkExtent2D extent{std::uint32_t(options.size.width), std::uint32_t(options.size.height)};
  GpuScene gpuScene(device, scene, withLog(options.gpuScene, context));
  std::uint64_t frame = 0;
  const Renderer renderer(device, gpuScene, {.largest = extent, .colour = ColourSupport::all});
  Offscreen offscreen(device, extent);
  ScopeTimer timer(device, 1);
  const auto milliseconds = [&](const FramePlan& plan) {
    offscreen.render([&](VkCommandBuffer commands) {
      timer.reset(commands);
      const GpuScope scope(commands, &timer, "frame");
      renderer.record(commands, plan, offscreen.target());
    });
    const std::vector<ScopeTime> times = timer.read();
    check(!times.empty(), ErrorCode::unsupported, "{}: the queue has no timestamps", device.name());
    return times[0].milliseconds;
  };

  Json frameList = Json::array();
  Table table;
  table.row({"cells", "drawn", "triangles", "way", "colour", "median ms", "p95 ms", "/ paper", "/ unmapped"});
  ProgressLine progress(context);
  for (std::size_t c = 0; c < options.cells.size(); ++c) {
    std::array<std::vector<double>, kWays.size()> times, toPaper, toUnmapped;
    std::size_t drawn = 0, triangles = 0;
    for (const View& view : views) {
      std::array<FramePlan, kWays.size()> plans;
      for (std::size_t w = 0; w < kWays.size(); ++w) {
        FrameInput input{{view.camera}, options.settings};
        input.settings.maxCells = std::uint32_t(options.cells[c]);
        input.settings.order = kWays[w].order;
        input.settings.colourMapping = kWays[w].colour;
        plans[w] = planFrame(scene, bounds, input);
      }
      streamAll(device, gpuScene, plans[0], frame);  // both show the same cells
      drawn = std::max(drawn, plans[0].cells.size());
      triangles = std::max(triangles, triangleCount(scene, plans[0]));
      for (int repeat = -1; repeat < options.repeat; ++repeat) {  // the first warms up and is not counted
        check(progress.show({"measuring", c, options.cells.size()}), ErrorCode::cancelled, "stopped");
        std::array<double, kWays.size()> time;
        for (std::size_t w = 0; w < kWays.size(); ++w) time[w] = milliseconds(plans[w]);
        for (std::size_t w = 0; repeat >= 0 && w < kWays.size(); ++w) {
          times[w].push_back(time[w]);
          toPaper[w].push_back(time[w] / time[0]);
          toUnmapped[w].push_back(time[w] / time[kWays[w].unmapped]);
        }
      }
    }
    for (std::size_t w = 0; w < kWays.size(); ++w) {
      const double median = quantile(times[w], 0.5), p95 = quantile(times[w], 0.95);
      frameList.push_back({{"cells", options.cells[c]},
                           {"drawn", drawn},
                           {"triangles", triangles},
                           {"way", kWays[w].name},
                           {"colourMapping", wordOf(kWays[w].colour)},
                           {"views", 1},
                           {"medianMs", median},
                           {"p95Ms", p95},
                           {"n", times[w].size()},
                           {"ratioToPaper", quantile(toPaper[w], 0.5)},
                           {"ratioToUnmapped", quantile(toUnmapped[w], 0.5)}});
      table.row({std::to_string(options.cells[c]), std::to_string(drawn), std::to_string(triangles), kWays[w].name,
                 wordOf(kWays[w].colour), numberText(median, 1), numberText(p95, 1),
                 numberText(quantile(toPaper[w], 0.5), 3), numberText(quantile(toUnmapped[w], 0.5), 3)});
    }
  }
  progress.show({"measuring", options.cells.size(), options.cells.size()});
  context.print("{}", table.text());
  context.report(Json{{"device", device.name()},
                      {"size", {options.size.width, options.size.height}},
                      {"frames", frameList},
                      {"passes", Json::array()},
                      {"settings", settingsJson(options.settings, options.gpuScene)},
                      {"scene", options.scene}}
                     .dump(2, ' ', false, Json::error_handler_t::replace));
  return kExitOk;
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
  const PhotographBench bench{scene, views, options.settings, options.gpuScene, options.repeat};
  Json report = options.walk.empty() ? benchFormats(bench, context) : benchWalk(bench, context);
  report["size"] = sizeOf(views[0]);
  report["settings"] = settingsJson(options.settings, options.gpuScene);
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
        "ibr bench scene --formats\n"
        "ibr bench scene --walk path.json --vram-budget 1G",
    .details =
        "Times are the device's, for one frame without the way back to the host. All settings but the order and\n"
        "colour mapping are the same for all. \"/ paper\" compares with the paper's order without colour mapping,\n"
        "\"/ unmapped\" with the same order without it. \"drawn\" is how many cells were in view at most.\n"
        "--formats compares formats of textures and filters instead, in time, memory and picture, against rgba8 with\n"
        "trilinear filters. --walk goes along a camera path as a viewer does: each frame shows what is there.",
    .afterInterrupt = "Nothing was written.",
    .declare = [](CLI::App& app) -> std::function<ExitCode(const Context&)> {
      const auto options = std::make_shared<Options>();
      app.add_option("SCENE", options->scene, "Scene folder")->required();
      addSize(app, "--size", options->size, "Size of the pictures [1920x1080; that of the path]");
      app.add_option("--cells", options->cells, "Numbers of cells to measure [1,5,12]")
          ->delimiter(',')
          ->check(CLI::Range(1, int(kLargestCellCount)))
          ->type_name("N,…");
      addInt(app, "--views", options->views, 1, 1000, "Views to measure, along an automatic path");
      addInt(app, "--repeat", options->repeat, 1, 10'000, "Frames of each way and view");
      declarePictureSettings(app, options->settings);
      declareGpuScene(app, options->gpuScene);
      auto* formats = app.add_flag("--formats", options->formats, "Measure formats of textures and filters");
      app.add_option("--walk", options->walk, "Walk along a camera path (see render), and measure memory")
          ->type_name("FILE")
          ->excludes(formats);
      return [options](const Context& context) {
        if (options->size.width == 0 && options->walk.empty()) options->size = {1920, 1080};
        const bool photographs = options->formats || !options->walk.empty();
        return photographs ? benchPhotographs(*options, context) : bench(*options, context);
      };
    }};

}  // namespace ibr::app
