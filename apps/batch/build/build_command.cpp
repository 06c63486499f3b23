// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "batch/build/build_options.h"
#include "batch/build/refinement_report.h"
#include "batch/command.h"
#include "batch/inspect/advice_report.h"
#include "batch/inspect/unused_photographs.h"
#include "ibr/author.h"
#include "shared/cli/progress.h"
#include "shared/report/table.h"

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  BuildChoices choices;
  std::string photographs, output;
  bool dryRun = false;
};

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : " ") + name;
  return text;
}

// A line or two, for people.
std::string predictionText(const BuildPrediction& p) {
  std::string text = fmt::format("{} photographs ({:.0f} megapixels), {}{} cells, {} backdrops: ", p.photographs,
                                 p.megapixels, p.cellsKnown ? "" : "perhaps ", p.cells, p.backdrops);
  if (!p.posesKnown) text += "poses are estimated first by COLMAP, which may take long, and memory of its own; then ";
  text += fmt::format("about {} on {} threads, at most {} of memory and {} of the disk", durationText(p.seconds),
                      p.threads, bytesText(p.memory), bytesText(p.disk));
  return p.diskFree > 0 ? text + fmt::format(" ({} free)", bytesText(p.diskFree)) : text;
}

Json predictionJson(const BuildPrediction& p) {
  Json json{{"photographs", p.photographs},
            {"megapixels", p.megapixels},
            {"cells", p.cells},
            {"cellsKnown", p.cellsKnown},
            {"backdrops", p.backdrops},
            {"posesKnown", p.posesKnown},
            {"threads", p.threads},
            {"seconds", p.seconds},
            {"processorSeconds", p.processorSeconds},
            {"memory", p.memory},
            {"memoryAllowed", p.memoryAllowed},
            {"disk", p.disk},
            {"diskFree", p.diskFree},
            {"stages", Json::array()}};
  for (const auto& stage : p.stages)
    json["stages"].push_back(
        {{"stage", stage.name}, {"seconds", stage.seconds}, {"processorSeconds", stage.processorSeconds}});
  return json;
}

using StageSeconds = std::vector<std::pair<std::string, double>>;

// A screen is not filled with hundreds of rows; a file or a pipe gets them all.
std::size_t rowsShown(std::size_t rows) {
  constexpr std::size_t kMost = 24;
  return ::isatty(STDOUT_FILENO) && rows > kMost ? kMost : rows;
}
std::string restText(std::size_t rows) {
  return rows > 0 ? fmt::format("… and {} more: --json writes all\n", rows) : std::string();
}

void printReport(const BuildReport& report, const StageSeconds& stages, const BuildOptions& options,
                 const Context& context) {
  Table cells;
  cells.row({"cell", "matcher", "points", "triangles", "tier 0", "coverage", "ECC", "residual px", "score", "s"});
  std::size_t points = 0, triangles = 0, resumed = 0;
  const std::size_t shown = rowsShown(report.cells.size());
  for (std::size_t c = 0; c < report.cells.size(); ++c) {
    const auto& cell = report.cells[c];
    if (c < shown)
      cells.row({joined(cell.members), methodName(cell.matcher), fmt::format("{}", cell.points),
                 fmt::format("{}", cell.triangles), fmt::format("{}", cell.tier0), numberText(cell.quality.coverage, 3),
                 numberText(cell.quality.ecc, 3), numberText(cell.quality.residualPx, 2),
                 numberText(cell.quality.score, 3), cell.resumed ? "kept" : numberText(cell.seconds, 1)});
    points += cell.points;
    triangles += cell.triangles;
    resumed += cell.resumed;
  }
  context.print("{}{}\n", cells.text(), restText(report.cells.size() - shown));
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
    const std::size_t rows = rowsShown(report.dropped.size());
    for (std::size_t d = 0; d < rows; ++d) dropped.row({report.dropped[d].what, report.dropped[d].reason});
    context.print("{}{}\n", dropped.text(), restText(report.dropped.size() - rows));
  }
  context.print("{}", unusedText(report.unused));
  if (!report.masks.empty()) {
    Table masks;
    masks.row({"masked photograph", "given", "moved"});
    for (const auto& [photograph, given, moved] : report.masks)
      masks.row({photograph, fmt::format("{:.2f} %", 100 * given), fmt::format("{:.2f} %", 100 * moved)});
    context.print("{}\n", masks.text());
  }
  for (const std::string& text : {report.exposures.text, report.exposures.vignetting})
    if (!text.empty()) context.print("{}\n\n", text);
  for (const auto& [stage, seconds] : stages) context.print("{:>9.1f} s  {}\n", seconds, stage);
  context.print("{:>9.1f} s  in all ({} were predicted), at most {} of memory (of {})\n\n", report.seconds,
                durationText(report.prediction.seconds), bytesText(report.memory), bytesText(report.prediction.memory));
  context.print("{}: {} cells ({} of them kept from before), {} points, {} triangles; {} cells dropped\n",
                options.output.string(), report.cells.size(), resumed, points, triangles, report.dropped.size());
}

Json reportJson(const BuildReport& report, const StageSeconds& stages, const BuildOptions& options) {
  Json json{{"scene", options.output.string()},
            {"photographs", options.photographs.string()},
            {"model", report.poses.string()},
            {"cells", Json::array()},
            {"backdrops", Json::array()},
            {"masks", Json::array()},
            {"exposures", nullptr},
            {"dropped", Json::array()},
            {"unused", unusedJson(report.unused)},
            {"stages", Json::array()},
            {"seconds", report.seconds},
            {"processorSeconds", report.processorSeconds},
            {"memory", report.memory},
            {"predicted", predictionJson(report.prediction)}};
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
                             {"processorSeconds", cell.processorSeconds},
                             {"resumed", cell.resumed}});
  for (const auto& backdrop : report.backdrops)
    json["backdrops"].push_back({{"photograph", backdrop.photograph},
                                 {"points", backdrop.points},
                                 {"triangles", backdrop.triangles},
                                 {"known", backdrop.known},
                                 {"seconds", backdrop.seconds},
                                 {"resumed", backdrop.resumed}});
  for (const auto& [photograph, given, moved] : report.masks)
    json["masks"].push_back({{"photograph", photograph}, {"given", given}, {"moved", moved}});
  if (const BuildReport::ExposureSummary& e = report.exposures; !e.text.empty())
    json["exposures"] = {{"measured", e.measured}, {"parts", e.parts}, {"alike", e.alike}, {"text", e.text}};
  if (!report.exposures.vignetting.empty()) json["vignetting"] = report.exposures.vignetting;
  for (const auto& [what, reason] : report.dropped) json["dropped"].push_back({{"what", what}, {"reason", reason}});
  for (const auto& [stage, seconds] : stages) json["stages"].push_back({{"stage", stage}, {"seconds", seconds}});
  return json;
}

ExitCode buildScene(const Options& options, const Context& context) {
  BuildOptions build = buildOptionsOf(options.choices, options.photographs, context);
  build.output = options.output;
  build.predicted = [&](const BuildPrediction& prediction) {
    if (options.dryRun)
      context.print("{}\n", predictionText(prediction));
    else
      context.say(LogLevel::info, "{}", predictionText(prediction));
    return !options.dryRun;
  };
  BuildReport report;
  StageSeconds stages;
  {
    ProgressLine progress(context);
    report = ibr::build(build, progress.callback(), context.log());
    stages = progress.stageSeconds();
  }
  if (options.dryRun) {
    context.report(Json{{"predicted", predictionJson(report.prediction)}}.dump(2));
    return kExitOk;
  }
  if (!report.refinement.steps.empty()) context.print("{}\n", text(report.refinement));
  printReport(report, stages, build, context);
  Json json = reportJson(report, stages, build);
  if (!report.refinement.steps.empty()) json["refinement"] = app::json(report.refinement);
  if (build.draft) {
    context.print("a draft, without cells: the same command without --draft makes the whole scene\n");
  } else {
    const Scene scene = loadScene(build.output);
    const CaptureAdvice advice = adviseCapture(scene);
    context.print("\nadvice\n{}", adviceText(advice));
    json["capture"] = adviceJson(scene, advice);
  }
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
        "ibr build photographs -o scene --draft\n"
        "ibr build photographs -o scene --dry-run --json -\n"
        "ibr build photographs -o scene --memory 8G --threads 4\n"
        "ibr build photographs -o scene --masks masks\n"
        "ibr build photographs -o scene --matcher homographic --triangle-filter homogeneous\n"
        "ibr build photographs -o scene --refine-poses auto\n"
        "ibr build photographs -o scene --exclude IMG_0007.jpg IMG_0015.jpg --json report.json",
    .details =
        "PHOTOS are photographs; their poses are a COLMAP model (text or binary), transforms.json, or for panoramas a "
        "model with EQUIRECTANGULAR cameras or --panoramas. Where there are none, the program COLMAP estimates them, "
        "in "
        "SCENE/.poses. Photographs of lenses that distort are undistorted; those of pinholes are stored as they are. "
        "The "
        "same input, options and seed give the same scene. A build that was stopped goes on where it was. Where "
        "photographs were added, it matches only what they change: finished depth and cells stay in SCENE/.build, "
        "which "
        "may be deleted, and COLMAP adds photographs to the poses in SCENE/.poses.",
    .afterInterrupt = "What was finished is kept: run the same command again to go on.",
    .declare = [](CLI::App& app) -> std::function<ExitCode(const Context&)> {
      const auto options = std::make_shared<Options>();
      app.add_option("PHOTOS", options->photographs, "Folder of the photographs")->required();
      app.add_option("-o,--output", options->output, "Scene folder; made where it is missing")
          ->required()
          ->type_name("SCENE");
      declareBuildOptions(app, options->choices);
      app.add_flag("--dry-run", options->dryRun,
                   "Only say how long it will take, and how much memory and disk; make nothing");
      return [options](const Context& context) { return buildScene(*options, context); };
    }};

}  // namespace ibr::app
