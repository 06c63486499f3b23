// SPDX-License-Identifier: Apache-2.0
// `ibr bench`: frame and pass times of a scene, for our methods and the paper's.
#include <memory>
#include <nlohmann/json.hpp>

#include "base/check.h"
#include "batch/bench/bench_photographs.h"
#include "batch/bench/bench_report.h"
#include "batch/command.h"
#include "batch/files/poses.h"
#include "shared/camera/auto_path.h"
#include "shared/cli/options.h"
#include "shared/cli/progress.h"
#include "shared/cli/settings.h"
#include "shared/draw/scene_renderer.h"

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string scene;
  std::vector<int> cells{1, 5, 12};
  BenchRun run;
  bool formats = false;
  std::string walk;  // file of a camera path
};

ExitCode bench(const Options& options, const Context& context) {
  Device device = Device::create({.device = context.options().device, .log = context.log()});
  ProgressLine progress(context);
  std::size_t done = 0;
  const auto step = [&] {
    check(progress.show({"measuring", done, options.cells.size()}), ErrorCode::cancelled, "stopped");
  };
  const BenchRun& run = options.run;
  BenchSubject subject{options.scene, loadScene(options.scene), batchOptions(run.gpuScene, context), {}};
  for (const View& view : frames(autoPath(subject.scene, run.views, run.size.width, run.size.height)))
    subject.views.push_back(view.camera);
  const FrameBench bench(device, subject, run.wanted);
  BenchReport report;
  for (const int cells : options.cells) {
    BenchCase wanted = run.wanted;
    wanted.settings.maxCells = std::uint32_t(cells);
    report.add(options.scene, wanted.settings, bench.measure(wanted, step));
    ++done;
  }
  progress.show({"measuring", done, done});
  report.print(context, device, run, options.scene);
  return kExitOk;
}

ExitCode benchPhotographs(const Options& options, const Context& context) {
  const Scene scene = loadScene(options.scene);
  const std::vector<View> views =
      options.walk.empty() ? frames(autoPath(scene, options.run.views, options.run.size.width, options.run.size.height))
                           : readViews(options.walk, options.run.size, context.log());
  const auto sizeOf = [](const View& view) {
    return std::pair(view.camera.intrinsics.width, view.camera.intrinsics.height);
  };
  for (const View& view : views)
    check(sizeOf(view) == sizeOf(views[0]), ErrorCode::invalidInput,
          "{}: {} and {} differ in size; give one size with --size", options.walk, views[0].name, view.name);
  const PhotographBench bench{scene, views, options.run.wanted.settings, options.run.gpuScene,
                              options.run.wanted.repeat};
  Json report = options.walk.empty() ? benchFormats(bench, context) : benchWalk(bench, context);
  report["size"] = sizeOf(views[0]);
  report["settings"] = settingsJson(options.run.wanted.settings, options.run.gpuScene);
  report["scene"] = options.scene;
  context.report(report);
  return kExitOk;
}

}  // namespace

const Command kBenchCommand{
    .name = "bench",
    .summary = "Measures frame times of a scene with our methods and the paper's, without and with colour mapping",
    .examples =
        "ibr bench scene\n"
        "ibr bench scene --size 1280x720 --cells 1,4,16 --repeat 15 --json times.json\n"
        "ibr bench scene --formats\n"
        "ibr bench scene --walk path.json --vram-budget 1G",
    .details =
        "Times are device times of one frame, without readback. All methods share all settings\n"
        "but draw order, colour mapping and blending. The paper's method draws cells, whatever\n"
        "--composition is.\n"
        "\"/ paper\": ratio to the paper's draw order without colour mapping\n"
        "\"/ unmapped\": ratio to the same draw order without colour mapping\n"
        "\"/ two\": ratio of two views to twice one view\n"
        "\"/ whole\": ratio of two views without the corners that a headset hides (18 % of the\n"
        "  pixels) to two full views\n"
        "\"drawn\": maximum number of cells in a view\n"
        "Our colour tables are computed in one frame of several; their time is the mean.\n"
        "--formats compares texture formats and filters in time, memory and image with rgba8 and\n"
        "trilinear filters.\n"
        "--walk follows a camera path as a viewer does: each frame shows the photographs that are\n"
        "loaded.",
    .afterInterrupt = "no report was written; run the same command again",
    .mainOptions = "size cells views repeat stereo preset formats walk json device",
    .declare = [](CLI::App& app) -> std::function<ExitCode(const Context&)> {
      const auto options = std::make_shared<Options>();
      addOption(app, "SCENE", options->scene, "Scene folder").required();
      addSize(app, "--size", options->run.size, "Size of the images [1920x1080; with --walk that of the path]");
      addOption(app, "--cells", options->cells, "Numbers of cells to measure [1,5,12]")
          .delimiter(',')
          .range(1, int(kMaxCellCount))
          .type("N,…");
      const Option stereo = declareBenchRun(app, options->run);
      const Option formats = addFlag(app, "--formats", options->formats, "Compare texture formats and texture filters");
      const Option walk = addOption(app, "--walk", options->walk,
                                    "Camera path to follow (see ibr render --help); also "
                                    "measures memory")
                              .type("FILE")
                              .excludes(formats);
      stereo.excludes(formats).excludes(walk);
      return [options](const Context& context) {
        if (options->run.size.width == 0 && options->walk.empty()) options->run.size = {1920, 1080};
        const bool photographs = options->formats || !options->walk.empty();
        return photographs ? benchPhotographs(*options, context) : bench(*options, context);
      };
    }};

}  // namespace ibr::app
