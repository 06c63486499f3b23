// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <nlohmann/json.hpp>

#include "base/check.h"
#include "batch/build/cell_figures.h"
#include "batch/build/optimise_options.h"
#include "batch/build/optimise_pictures.h"
#include "batch/command.h"
#include "shared/cli/options.h"
#include "shared/cli/progress.h"
#include "shared/report/table.h"

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  OptimiseSceneOptions scene;
  std::string input, output, pictures;
};

// Columns of [T] table 4, with both definitions of ECC.
void printTable(const OptimiseSceneReport& report, const Context& context) {
  Table table;
  table.row({"cell", "images", "resolution", "points", "initial ECC", "final ECC", "initial (paper)", "final (paper)",
             "cycles", "s"});
  const auto row = [&](const std::string& name, const std::string& resolution, const std::string& cycles,
                       const auto& figure) {
    table.row({name, numberText(figure(1), 0), resolution, numberText(figure(0), 0), numberText(figure(2), 4),
               numberText(figure(3), 4), numberText(figure(4), 4), numberText(figure(5), 4), cycles,
               numberText(figure(6), 1)});
  };
  for (const OptimisedCell& cell : report.cells)
    row(fmt::format("{}", cell.cell), fmt::format("{}x{}", cell.width, cell.height),
        cell.cached ? "cached" : fmt::format("{}", cell.summary.cycles.size()),
        [&](std::size_t f) { return kCellFigures[f].second(cell); });
  if (report.cells.size() > 1)
    row("mean", "", "", [&](std::size_t f) { return meanOf(report, kCellFigures[f].second); });
  context.print("{}\n", table.text());
}

Json reportJson(const OptimiseSceneReport& report, const Options& options) {
  const AlignmentOptions& alignment = options.scene.cells.alignment;
  Json json{{"cells", Json::array()}, {"mean", Json::object()}};
  for (const OptimisedCell& cell : report.cells) {
    Json line{{"cell", cell.cell}};
    for (const auto& [name, value] : kCellFigures) line[name] = value(cell);
    line["points"] = cell.points;
    line["images"] = cell.members.size();
    const AlignmentCycle all = sumOf(cell.summary.cycles);
    line.update({{"members", cell.members},
                 {"resolution", {cell.width, cell.height}},
                 {"triangles", cell.evaluated},
                 {"moved", cell.moved},
                 {"flipped", cell.flipped},
                 {"inserted", cell.inserted},
                 {"fixed", cell.fixed},
                 {"reverted", cell.reverted},
                 {"cycles", cell.summary.cycles.size()},
                 {"bestCycle", cell.summary.bestCycle},
                 {"mutations", all.mutations},
                 {"pixels", all.pixels},
                 {"refused", all.refused},
                 {"resumed", cell.cached}});
    json["cells"].push_back(line);
  }
  for (const auto& [name, value] : kCellFigures) json["mean"][name] = meanOf(report, value);
  json.update({{"scene", options.input},
               {"output", options.output},
               {"method", optionValue(alignment.method)},
               {"definition", optionValue(alignment.definition)},
               {"instances", alignment.instances},
               {"radius", alignment.radiusPx},
               {"decay", alignment.decay},
               {"threshold", alignment.threshold},
               {"rigidity", alignment.rigidity},
               {"epipolar", alignment.epipolarWeight},
               {"levels", alignment.levels},
               {"escape", alignment.escape},
               {"flipEdges", alignment.flipEdges},
               {"flipGain", alignment.flipGain},
               {"insertPoints", alignment.insertPoints},
               {"insertBelow", alignment.insertBelow},
               {"insertGain", alignment.insertGain},
               {"prune", alignment.prune},
               {"seed", alignment.seed},
               {"seconds", report.seconds}});
  return json;
}

ExitCode optimise(Options options, const Context& context) {
  OptimiseSceneOptions& scene = options.scene;
  scene.scene = options.input;
  scene.output = options.output;
  scene.cells.threads = context.options().threads;
  scene.cells.alignment.seed = context.options().seed;
  const std::string fault = firstInvalidOption(scene.cells.alignment);
  check(fault.empty(), ErrorCode::invalidInput, "{}", fault);
  const Aligner aligner = makeAligner(scene.cells.alignment.method, context);
  OptimiseSceneReport report;
  {
    ProgressLine progress(context);
    report = optimiseScene(scene, aligner, progress.callback(), context.log());
    if (!options.pictures.empty()) {
      const Scene before = loadScene(options.input), after = loadScene(options.output);
      for (std::size_t k = 0; k < report.cells.size(); ++k) {
        check(progress.show({"drawing images", k, report.cells.size()}), ErrorCode::cancelled, "stopped");
        writeOptimisePictures(before, after, report.cells[k], options.pictures);
      }
    }
  }
  printTable(report, context);
  context.print("{}: {} cells optimised in {:.1f} s\n", options.output, report.cells.size(), report.seconds);
  context.report(reportJson(report, options));
  return kExitOk;
}

}  // namespace

const Command kOptimiseCommand{
    .name = "optimise",
    .summary = "Optimises the meshes of a scene until its photographs agree best",
    .examples =
        "ibr optimise scene -o sharper\n"
        "ibr optimise scene -o sharper --pictures compared --json report.json\n"
        "ibr optimise scene -o sharper --cells-only 0 3 --radius 8 --threshold 0\n"
        "ibr build photographs -o scene --optimise",
    .details =
        "Each point moves in each photograph to a nearby position. There, the triangles around\n"
        "the point correlate better half-way between the photographs. No triangle folds over. A\n"
        "move is rejected if the rays of the photographs diverge after the move. The table lists\n"
        "the mean correlation (ECC) of all points before and after. The ECC uses one mean per\n"
        "channel; the columns of the paper use one mean for all. Photographs and textures are\n"
        "linked, not copied.\n"
        "--pictures draws the image half-way between the photographs of each cell, under a map of\n"
        "the correlation (hot: bad). Images before and after are side by side, together with the\n"
        "positions that changed most.",
    .afterInterrupt = "finished cells are cached; run the same command again to resume",
    .mainOptions = "output method instances radius decay threshold rigidity flip-edges pictures json",
    .declare = [](CLI::App& app) -> std::function<ExitCode(const Context&)> {
      const auto options = std::make_shared<Options>();
      addOption(app, "SCENE", options->input, "Scene folder").required();
      addOption(app, "-o,--output", options->output, "Folder of the optimised scene; created if missing")
          .required()
          .type("SCENE2");
      declareAlignment(app, options->scene.cells.alignment);
      declareCellsOnly(app, options->scene.cells.cells, "Optimise only these cells, by number");
      addOption(app, "--pictures", options->pictures, "Folder for images of each cell before and after").type("DIR");
      return [options](const Context& context) { return optimise(*options, context); };
    }};

}  // namespace ibr::app
