// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "batch/advice_report.h"
#include "batch/build_options.h"
#include "batch/command.h"
#include "batch/unused.h"
#include "ibr/author.h"
#include "shared/progress.h"
#include "shared/table.h"

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  BuildChoices choices;
  std::string photographs, output;
};

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : " ") + name;
  return text;
}

using StageSeconds = std::vector<std::pair<std::string, double>>;

void printReport(const BuildReport& report, const StageSeconds& stages, const BuildOptions& options,
                 const Context& context) {
  Table cells;
  cells.row(
      {"cell", "matcher", "points", "triangles", "tier 0", "coverage", "ECC", "residual px", "score", "s"});
  std::size_t points = 0, triangles = 0, resumed = 0;
  for (const auto& cell : report.cells) {
    cells.row({joined(cell.members), methodName(cell.matcher), fmt::format("{}", cell.points),
               fmt::format("{}", cell.triangles),
               fmt::format("{}", cell.tier0), numberText(cell.quality.coverage, 3), numberText(cell.quality.ecc, 3),
               numberText(cell.quality.residualPx, 2), numberText(cell.quality.score, 3),
               cell.resumed ? "kept" : numberText(cell.seconds, 1)});
    points += cell.points;
    triangles += cell.triangles;
    resumed += cell.resumed;
  }
  context.print("{}\n", cells.text());
  std::size_t backdropPoints = 0, backdropTriangles = 0;
  double known = 0;
  for (const auto& backdrop : report.backdrops) {
    backdropPoints += backdrop.points;
    backdropTriangles += backdrop.triangles;
    known += backdrop.known / double(report.backdrops.size());
  }
  if (!report.backdrops.empty())
    context.print("{} backdrops: {} points, {} triangles; {:.0f} % of their depth was matched, the rest is completed\n",
                  report.backdrops.size(), backdropPoints, backdropTriangles, 100 * known);
  if (!report.dropped.empty()) {
    Table dropped;
    dropped.row({"dropped cell", "why"});
    for (const auto& [what, reason] : report.dropped) dropped.row({what, reason});
    context.print("{}\n", dropped.text());
  }
  context.print("{}", unusedText(report.unused));
  for (const auto& [stage, seconds] : stages) context.print("{:>9.1f} s  {}\n", seconds, stage);
  context.print("{:>9.1f} s  in all\n\n", report.seconds);
  context.print("{}: {} cells ({} of them kept from before), {} points, {} triangles; {} cells dropped\n",
                options.output.string(), report.cells.size(), resumed, points, triangles, report.dropped.size());
}

Json reportJson(const BuildReport& report, const StageSeconds& stages, const BuildOptions& options) {
  Json json{{"scene", options.output.string()},
            {"photographs", options.photographs.string()},
            {"model", report.poses.string()},
            {"cells", Json::array()},
            {"backdrops", Json::array()},
            {"dropped", Json::array()},
            {"unused", unusedJson(report.unused)},
            {"stages", Json::array()},
            {"seconds", report.seconds}};
  for (const auto& cell : report.cells)
    json["cells"].push_back({{"members", cell.members},
                             {"points", cell.points},
                             {"triangles", cell.triangles},
                             {"tier0", cell.tier0},
                             {"coverage", cell.quality.coverage},
                             {"ecc", cell.quality.ecc},
                             {"residualPx", cell.quality.residualPx},
                             {"score", cell.quality.score},
                             {"matcher", methodName(cell.matcher)},
                             {"homogeneous", std::isnan(cell.homogeneous) ? Json(nullptr) : Json(cell.homogeneous)},
                             {"seconds", cell.seconds},
                             {"resumed", cell.resumed}});
  for (const auto& backdrop : report.backdrops)
    json["backdrops"].push_back({{"photograph", backdrop.photograph},
                                 {"points", backdrop.points},
                                 {"triangles", backdrop.triangles},
                                 {"known", backdrop.known},
                                 {"seconds", backdrop.seconds},
                                 {"resumed", backdrop.resumed}});
  for (const auto& [what, reason] : report.dropped) json["dropped"].push_back({{"what", what}, {"reason", reason}});
  for (const auto& [stage, seconds] : stages) json["stages"].push_back({{"stage", stage}, {"seconds", seconds}});
  return json;
}

ExitCode buildScene(const Options& options, const Context& context) {
  BuildOptions build = buildOptionsOf(options.choices, options.photographs, context);
  build.output = options.output;
  BuildReport report;
  StageSeconds stages;
  {
    ProgressLine progress(context);
    report = ibr::build(build, progress.callback(), context.log());
    stages = progress.stageSeconds();
  }
  printReport(report, stages, build, context);
  Json json = reportJson(report, stages, build);
  const Scene scene = loadScene(build.output);
  const CaptureAdvice advice = adviseCapture(scene);
  context.print("\nadvice\n{}", adviceText(advice));
  json["capture"] = adviceJson(scene, advice);
  context.report(json.dump(2, ' ', false, Json::error_handler_t::replace));
  return kExitOk;
}

}  // namespace

const Command kBuildCommand{
    .name = "build",
    .summary = "Makes a scene from photographs",
    .examples =
        "ibr build photographs -o scene\n"
        "ibr build photographs --model colmap/sparse/0 -o scene --max-size 1600\n"
        "ibr build photographs --transforms transforms.json -o scene\n"
        "ibr build photographs -o scene --matcher homographic --triangle-filter homogeneous\n"
        "ibr build photographs -o scene --exclude IMG_0007.jpg IMG_0015.jpg --json report.json",
    .details =
        "PHOTOS are photographs; their poses are a COLMAP model (text or binary), transforms.json, or for panoramas a "
        "model with EQUIRECTANGULAR cameras or --panoramas. Where there are none, the program COLMAP estimates them, in "
        "SCENE/.poses. Photographs of lenses that distort are undistorted; those of pinholes are stored as they are. The "
        "same input, options and seed give the same scene. A build that was stopped goes on where it was.",
    .afterInterrupt = "What was finished is kept: run the same command again to go on.",
    .declare = [](CLI::App& app) -> std::function<ExitCode(const Context&)> {
      const auto options = std::make_shared<Options>();
      app.add_option("PHOTOS", options->photographs, "Folder of the photographs")->required();
      app.add_option("-o,--output", options->output, "Scene folder; made where it is missing")
          ->required()
          ->type_name("SCENE");
      declareBuildOptions(app, options->choices);
      return [options](const Context& context) { return buildScene(*options, context); };
    }};

}  // namespace ibr::app
