// SPDX-License-Identifier: Apache-2.0
// Frame and pass times of synthetic scenes with the sizes of those in [T] table 2.
#include <memory>

#include "base/check.h"
#include "batch/bench/bench_report.h"
#include "batch/command.h"
#include "ibr/texture.h"
#include "lab/generate/bench_scene.h"
#include "lab/lab_commands.h"
#include "shared/cli/options.h"
#include "shared/cli/progress.h"
#include "shared/draw/scene_renderer.h"

namespace ibr::app {
namespace {

struct Options {
  std::vector<const BenchShape*> generated;
  double detail = 1;  // of the synthetic photographs' textures
  BenchRun run;
};

ExitCode bench(const Options& options, const Context& context) {
  Device device = Device::create({.device = context.options().device, .log = context.log()});
  ProgressLine progress(context);
  std::size_t done = 0;
  const auto step = [&] {
    check(progress.show({"measuring", done, options.generated.size()}), ErrorCode::cancelled, "stopped");
  };
  const BenchRun& run = options.run;
  BenchReport report;
  for (const BenchShape* shape : options.generated) {
    step();
    GpuSceneOptions gpuScene = batchOptions(run.gpuScene, context);
    gpuScene.source = [](const Scene& scene, std::size_t node, int firstLevel) {
      return withoutLargestLevels(benchPhotograph(scene, node), firstLevel);
    };
    const BenchSubject subject{shape->name, makeBenchScene(*shape, options.detail), gpuScene,
                               benchViews(*shape, run.views, run.size.width, run.size.height)};
    BenchCase wanted = run.wanted;
    wanted.settings.maxCells = std::uint32_t(shape->cells);
    report.add(shape->name, wanted.settings, FrameBench(device, subject, run.wanted).measure(wanted, step));
    ++done;
  }
  progress.show({"measuring", done, done});
  report.print(context, device, run, "");
  return kExitOk;
}

void declareGenerated(CLI::App& app, Options& options) {
  std::string names;
  for (const BenchShape& shape : benchShapes()) names += (names.empty() ? "" : ", ") + std::string(shape.name);
  addParsedList(
      app, "NAME",
      [&options](const std::vector<std::string>& wanted) {
        for (const std::string& name : wanted) {
          const BenchShape* shape = findBenchShape(name);
          if (!shape && name != "all") refuseOption("NAME", "'" + name + "' is not a synthetic scene");
          for (const BenchShape& each : benchShapes())
            if (shape == &each || name == "all") options.generated.push_back(&each);
        }
      },
      "Synthetic scenes: all, or names of " + names)
      .required()
      .delimiter(',');
  addDouble(app, "--detail", options.detail, 0.01, 1,
            "Size of synthetic photographs, as a factor on 1280x960 (panoramas: 2048x1024)");
}

}  // namespace

const Command kLabBenchCommand{.name = "bench",
                               .summary = "Measures frame times of synthetic scenes with our methods and the paper's",
                               .examples = "ibr-lab bench all\nibr-lab bench stitched-12 stacked-12 --stereo --json -",
                               .details = "All cells of each scene are drawn. The columns are those of `ibr bench`.",
                               .afterInterrupt = "no report was written; run the same command again",
                               .declare = [](CLI::App& app) -> std::function<ExitCode(const Context&)> {
                                 const auto options = std::make_shared<Options>();
                                 declareGenerated(app, *options);
                                 options->run.size = {1920, 1080};
                                 addSize(app, "--size", options->run.size, "Size of the images [1920x1080]");
                                 declareBenchRun(app, options->run);
                                 return [options](const Context& context) { return bench(*options, context); };
                               }};

}  // namespace ibr::app
