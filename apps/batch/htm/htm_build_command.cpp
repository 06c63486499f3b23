// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <nlohmann/json.hpp>

#include "batch/htm/htm_commands.h"
#include "batch/htm/htm_options.h"
#include "batch/htm/htm_report.h"
#include "batch/htm/htm_stage_pictures.h"
#include "shared/cli/options.h"
#include "shared/cli/progress.h"
#include "shared/report/table.h"

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  HtmBuildChoices choices;
  std::string mesh, model, images, masks, output, stages;
};

std::string percent(double share) {
  return fmt::format("{:.1f} %", 100 * share);
}

void printReport(const HtmReport& report, const HtmBuildOptions& options, const Context& context) {
  context.print(
      "{} faces reduced to {} by shape: off by {:.3g} on average and {:.3g} at most there, {:.3g} and {:.3g} back\n",
      report.sourceFaces, report.reducedFaces, report.reducedMean, report.reducedMost, report.restoredMean,
      report.restoredMost);
  for (const HtmReport::Adjustment& line : report.adjustments)
    context.print(
        "adjusted: cameras see vertices {:.2f} px from where the pictures agree, {:.2f} px before; vertices moved "
        "{:.3g}\n",
        line.afterPx, line.beforePx, line.moved);
  context.print("{} edges of inconsistent faces collapsed: mean D_f {:.3f}, before {:.3f}\n", report.collapses,
                report.collapsedDifference, report.reducedDifference);
  Table rounds;
  rounds.row(
      {"round", "vertices", "faces", "D_f as it is", "D_f harmonised", "matched", "divided", "for being hidden"});
  for (std::size_t r = 0; r < report.rounds.size(); ++r) {
    const HtmReport::Round& round = report.rounds[r];
    rounds.row({fmt::format("{}", r + 1), fmt::format("{}", round.vertices), fmt::format("{}", round.faces),
                numberText(round.before, 3), numberText(round.after, 3), percent(round.measured),
                fmt::format("{}", round.divided), fmt::format("{}", round.divideHidden)});
  }
  context.print("{}{:.2f} cameras see a vertex; {} of them do not agree and are left out there\n", rounds.text(),
                report.camerasPerVertex, percent(report.rejected));
  double seconds = 0;
  for (const HtmReport::Stage& stage : report.stages) {
    context.print("{:>9.1f} s  {}\n", stage.seconds, stage.name);
    seconds += stage.seconds;
  }
  context.print("{:>9.1f} s  in all\n\n{}: complements take {}\n", seconds, options.output.string(),
                bytesText(double(report.complementBytes)));
}

ExitCode buildModel(const Options& options, const Context& context) {
  HtmBuildOptions build = options.choices.build;
  build.mesh = options.mesh;
  build.model = options.model;
  build.images = options.images;
  build.masks = options.masks;
  build.output = options.output;
  const std::unique_ptr<Device> device = prepare(build, options.choices, context);
  HtmResult result;
  {
    ProgressLine progress(context);
    result = buildHtm(build, progress.callback(), context.log());
  }
  if (!options.stages.empty()) writeStages(options.stages, result.stages, result.model.cameras.front().camera);
  printReport(result.report, build, context);
  Json report{{"model", options.output}, {"mesh", options.mesh}};
  report.update(htmReportJson(result.report));
  context.report(report.dump(2, ' ', false, Json::error_handler_t::replace));
  return kExitOk;
}

}  // namespace

const Command kHtmBuildCommand{
    .name = "build",
    .summary = "Makes a harmonised model from a mesh, cameras and their photographs",
    .examples =
        "ibr htm build --mesh object.ply --model sparse --images images --masks masks -o model\n"
        "ibr htm build --mesh object.obj --model sparse --images images --adjust 0 --smoothness 0 -o papers-way\n"
        "ibr htm build --mesh object.glb --model sparse --images images -o model --stages figures",
    .details =
        "The mesh (PLY, OBJ, glTF) stands in the world of the COLMAP model. It may be rough, and cameras a few pixels\n"
        "off: the mesh is made coarse, what each two photographs show at its vertices is matched, and the differences\n"
        "are kept, so that photographs can be bent to agree while they are drawn. Where they still differ, the mesh "
        "is\n"
        "made finer and matched again. Masks are white where the object is.\n"
        "D_f is how differently photographs colour a face, in levels of 255.\n"
        "--stages writes the meshes on the way, coloured by D_f, and a picture of them.",
    .afterInterrupt = "Nothing was written; run the same command again.",
    .declare = [](CLI::App& app) -> std::function<ExitCode(const Context&)> {
      const auto options = std::make_shared<Options>();
      app.add_option("--mesh", options->mesh, "Mesh file")->required()->type_name("FILE");
      app.add_option("--model", options->model, "COLMAP model's folder")->required()->type_name("DIR");
      app.add_option("--images", options->images, "Folder of the photographs")->required()->type_name("DIR");
      app.add_option("--masks", options->masks, "Folder of masks, NAME.png each")->type_name("DIR");
      app.add_option("-o,--output", options->output, "Model folder; made where it is missing")
          ->required()
          ->type_name("MODEL");
      app.add_option("--stages", options->stages, "Folder for the meshes on the way")->type_name("DIR");
      declareHtmBuildOptions(app, options->choices);
      return [options](const Context& context) { return buildModel(*options, context); };
    }};

}  // namespace ibr::app
