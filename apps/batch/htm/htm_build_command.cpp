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
      "{} faces were reduced to {} by shape: distance of source to reduced mesh {:.3g} (mean), {:.3g} (maximum), of "
      "reduced to source mesh {:.3g} (mean), {:.3g} (maximum)\n",
      report.sourceFaces, report.reducedFaces, report.reducedMean, report.reducedMax, report.restoredMean,
      report.restoredMax);
  for (const HtmReport::Adjustment& line : report.adjustments)
    context.print(
        "cameras and shape were adjusted: RMS offset of vertices from the cameras' consensus {:.2f} px, before "
        "{:.2f} px; vertices moved by {:.3g} (mean)\n",
        line.afterPx, line.beforePx, line.meanDisplacement);
  context.print("{} edges of inconsistent faces were collapsed: mean D_f {:.3f}, before {:.3f}\n", report.collapses,
                report.collapsedDifference, report.reducedDifference);
  Table rounds;
  rounds.row(
      {"round", "vertices", "faces", "D_f unharmonised", "D_f harmonised", "matched", "divided", "divided as hidden"});
  for (std::size_t r = 0; r < report.rounds.size(); ++r) {
    const HtmReport::Round& round = report.rounds[r];
    rounds.row({fmt::format("{}", r + 1), fmt::format("{}", round.vertices), fmt::format("{}", round.faces),
                numberText(round.unharmonisedDifference, 3), numberText(round.harmonisedDifference, 3),
                percent(round.matchedShare), fmt::format("{}", round.divided),
                fmt::format("{}", round.dividedAsHidden)});
  }
  context.print("{}{:.2f} cameras see a vertex on average; {} of these disagree at the vertex and are rejected\n",
                rounds.text(), report.camerasPerVertex, percent(report.rejected));
  double seconds = 0;
  for (const HtmReport::Stage& stage : report.stages) {
    context.print("{:>9.1f} s  {}\n", stage.seconds, stage.name);
    seconds += stage.seconds;
  }
  context.print("{:>9.1f} s  total\n\n{}: complements take {}\n", seconds, options.output.string(),
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
  context.report(report);
  return kExitOk;
}

}  // namespace

const Command kHtmBuildCommand{
    .name = "build",
    .summary = "Builds a harmonised model from a mesh, cameras and their photographs",
    .examples =
        "ibr htm build --mesh object.ply --model sparse --images images --masks masks -o model\n"
        "ibr htm build --mesh object.obj --model sparse --images images --adjust 0 --smoothness 0 -o papers-way\n"
        "ibr htm build --mesh object.glb --model sparse --images images -o model --stages figures",
    .details =
        "The mesh (PLY, OBJ, glTF) is in the world coordinates of the COLMAP model. The mesh may\n"
        "be rough, and cameras may be inaccurate by a few pixels. First, the mesh is made\n"
        "coarser, and each two photographs are matched at its vertices. The displacements are\n"
        "stored, so that photographs can be warped to agree during drawing. Where photographs\n"
        "still differ, the mesh is refined and matched again. Masks are white on the object.\n"
        "D_f is the colour difference of the photographs on a face, in 8-bit levels.\n"
        "--stages writes the intermediate meshes, coloured by D_f, and an image of them.",
    .afterInterrupt = "no model was written; run the same command again",
    .mainOptions = "mesh model images masks output faces adjust rounds stages json",
    .declare = [](CLI::App& app) -> std::function<ExitCode(const Context&)> {
      const auto options = std::make_shared<Options>();
      addOption(app, "--mesh", options->mesh, "Mesh file").required().type("FILE");
      addOption(app, "--model", options->model, "COLMAP model folder").required().type("DIR");
      addOption(app, "--images", options->images, "Folder of the photographs").required().type("DIR");
      addOption(app, "--masks", options->masks, "Folder of masks, a NAME.png per photograph").type("DIR");
      addOption(app, "-o,--output", options->output, "Model folder; created if missing").required().type("MODEL");
      addOption(app, "--stages", options->stages, "Folder for the intermediate meshes").type("DIR");
      declareHtmBuildOptions(app, options->choices);
      return [options](const Context& context) { return buildModel(*options, context); };
    }};

}  // namespace ibr::app
