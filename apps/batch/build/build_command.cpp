// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/check.h"
#include "batch/build/build_options.h"
#include "batch/build/build_sources.h"
#include "batch/build/build_steps_command.h"
#include "batch/build/refinement_report.h"
#include "batch/command.h"
#include "batch/inspect/advice_report.h"
#include "batch/inspect/unused_photographs.h"
#include "ibr/author/build.h"
#include "shared/cli/options.h"
#include "shared/cli/progress.h"
#include "shared/report/table.h"

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  BuildChoices choices;
  std::vector<std::string> photographs;
  std::string output;
  int videoFrames = 0;
  bool dryRun = false;
  StepChoices steps;
};

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : " ") + name;
  return text;
}

// Formats the prediction in one or two lines, for people.
std::string predictionText(const BuildPrediction& p) {
  std::string text = fmt::format("{} photographs ({:.0f} megapixels), {}{} cells, {} backdrops: ", p.photographs,
                                 p.megapixels, p.cellCountKnown ? "" : "perhaps ", p.cells, p.backdrops);
  if (!p.posesKnown)
    text +=
        "unless an earlier run did, COLMAP first estimates the poses, which may take long and needs memory of its own; "
        "then ";
  text += fmt::format("about {} on {} {}, at most {} of memory and {} of disk space", durationText(p.seconds),
                      p.threads, p.threads == 1 ? "thread" : "threads", bytesText(p.memory), bytesText(p.disk));
  return p.diskFreeBytes > 0 ? text + fmt::format(" ({} free)", bytesText(p.diskFreeBytes)) : text;
}

Json predictionJson(const BuildPrediction& p) {
  Json json{{"photographs", p.photographs},
            {"megapixels", p.megapixels},
            {"cells", p.cells},
            {"cellsKnown", p.cellCountKnown},
            {"backdrops", p.backdrops},
            {"posesKnown", p.posesKnown},
            {"threads", p.threads},
            {"seconds", p.seconds},
            {"processorSeconds", p.cpuSeconds},
            {"memory", p.memory},
            {"memoryAllowed", p.memoryLimitBytes},
            {"disk", p.disk},
            {"diskFree", p.diskFreeBytes},
            {"stages", Json::array()}};
  for (const auto& stage : p.stages)
    json["stages"].push_back(
        {{"stage", stage.name}, {"seconds", stage.seconds}, {"processorSeconds", stage.cpuSeconds}});
  return json;
}

using StageSeconds = std::vector<std::pair<std::string, double>>;

std::string percent(double share) {
  return fmt::format("{:.0f} %", 100 * share);
}

// Tables of the cells, the dropped cells, the masks and the stages.
std::string tablesText(const BuildReport& report, const StageSeconds& stages) {
  Table cells, dropped, masks;
  cells.row({"cell", "matcher", "points", "triangles", "tier 0", "coverage", "ECC", "residual px", "score", "s"});
  for (const auto& cell : report.cells)
    cells.row({joined(cell.members), matchMethodName(cell.matcher), fmt::format("{}", cell.points),
               fmt::format("{}", cell.triangles), fmt::format("{}", cell.tier0), numberText(cell.quality.coverage, 3),
               numberText(cell.quality.ecc, 3), numberText(cell.quality.residualPx, 2),
               numberText(cell.quality.score, 3), cell.cached ? "cached" : numberText(cell.seconds, 1)});
  std::string text = cells.text() + "\n";
  if (!report.dropped.empty()) {
    dropped.row({"dropped cell", "reason"});
    for (const auto& [what, reason] : report.dropped) dropped.row({what, reason});
    text += dropped.text() + "\n";
  }
  if (!report.masks.empty()) {
    masks.row({"masked photograph", "given masks", "moving objects"});
    for (const auto& [photograph, given, moved] : report.masks)
      masks.row({photograph, fmt::format("{:.2f} %", 100 * given), fmt::format("{:.2f} %", 100 * moved)});
    text += masks.text() + "\n";
  }
  for (const auto& [stage, seconds] : stages) text += fmt::format("{:>9.1f} s  {}\n", seconds, stage);
  return text + "\n";
}

std::string masksText(const BuildReport& report) {
  double given = 0, moved = 0;
  for (const auto& mask : report.masks) given += mask.givenShare, moved += mask.movingShare;
  return fmt::format(
      "{} photographs have masks: given masks cover {:.2f} %, moving objects {:.2f} % of all photographs\n",
      report.masks.size(), 100 * given / double(report.prediction.photographs),
      100 * moved / double(report.prediction.photographs));
}

// One line for each part of the scene.
std::string summaryText(const BuildReport& report, const BuildOptions& options) {
  std::size_t triangles = 0, cached = 0;
  for (const auto& cell : report.cells) triangles += cell.triangles, cached += cell.cached;
  double known = 0;
  for (const auto& backdrop : report.backdrops) known += backdrop.matchedShare / double(report.backdrops.size());
  std::string text = fmt::format("{}: {} photographs, {} cells of {} triangles", options.output.string(),
                                 report.prediction.photographs, report.cells.size(), triangles);
  if (cached > 0) text += fmt::format(" ({} cells cached)", cached);
  if (!report.dropped.empty()) text += fmt::format("; {} cells dropped (-v lists them)", report.dropped.size());
  text += '\n';
  if (!report.backdrops.empty())
    text += fmt::format("depth: {} of the photographs' pixels matched, the rest completed\n", percent(known));
  text += unusedText(report.unusedPhotographs);
  if (!report.masks.empty()) text += masksText(report);
  for (const std::string& line : {report.exposures.text, report.exposures.vignetting})
    if (!line.empty()) text += line + '\n';
  return text + fmt::format("took {} ({} predicted{}), peak memory {} ({} predicted)\n", durationText(report.seconds),
                            durationText(report.prediction.seconds),
                            report.prediction.posesKnown ? "" : ", without COLMAP", bytesText(report.memory),
                            bytesText(report.prediction.memory));
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
            {"unused", unusedJson(report.unusedPhotographs)},
            {"stages", Json::array()},
            {"seconds", report.seconds},
            {"processorSeconds", report.cpuSeconds},
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
                             {"matcher", matchMethodName(cell.matcher)},
                             {"homogeneous", std::isnan(cell.homogeneous) ? Json(nullptr) : Json(cell.homogeneous)},
                             {"seconds", cell.seconds},
                             {"processorSeconds", cell.cpuSeconds},
                             {"resumed", cell.cached}});
  for (const auto& backdrop : report.backdrops)
    json["backdrops"].push_back({{"photograph", backdrop.photograph},
                                 {"points", backdrop.points},
                                 {"triangles", backdrop.triangles},
                                 {"matchedShare", backdrop.matchedShare},
                                 {"seconds", backdrop.seconds},
                                 {"resumed", backdrop.cached}});
  for (const auto& [photograph, given, moved] : report.masks)
    json["masks"].push_back({{"photograph", photograph}, {"given", given}, {"moved", moved}});
  if (const BuildReport::ExposureSummary& e = report.exposures; !e.text.empty())
    json["exposures"] = {{"measured", e.measured}, {"parts", e.parts}, {"alike", e.alike}, {"text", e.text}};
  if (!report.exposures.vignetting.empty()) json["vignetting"] = report.exposures.vignetting;
  for (const auto& [what, reason] : report.dropped) json["dropped"].push_back({{"item", what}, {"reason", reason}});
  for (const auto& [stage, seconds] : stages) json["stages"].push_back({{"stage", stage}, {"seconds", seconds}});
  return json;
}

ExitCode buildScene(const Options& options, const Context& context) {
  const bool inSteps = options.steps.list || !options.steps.step.empty();
  check(!inSteps || (options.photographs.size() == 1 && std::filesystem::is_directory(options.photographs[0])),
        ErrorCode::invalidInput, "steps need one folder of photographs; extract the frames of videos before");
  VideoOptions video;
  video.frames = std::size_t(options.videoFrames);
  video.keepMetadata = !options.choices.build.stripMetadata;
  const std::filesystem::path photographs = photographsOf(options.photographs, options.output, video, context);
  BuildOptions build = buildOptionsOf(options.choices, photographs, context);
  build.output = options.output;
  // A model of all frames of a video has more than are chosen.
  build.skipMissing = std::ranges::any_of(
      options.photographs, [](const std::string& source) { return !std::filesystem::is_directory(source); });
  if (options.steps.list) return listSteps(options.steps, build, context);
  if (inSteps && options.steps.step != kSceneStep) return runStep(options.steps, build, context);
  if (inSteps) build = sceneStepOptions(build);
  build.onPrediction = [&](const BuildPrediction& prediction) {
    if (options.dryRun)
      context.print("{}\n", predictionText(prediction));
    else
      context.logMessage(LogLevel::info, "{}", predictionText(prediction));
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
    context.report({{"predicted", predictionJson(report.prediction)}});
    return kExitOk;
  }
  if (!report.refinement.steps.empty()) context.print("{}\n", text(report.refinement));
  if (context.options().verbose) context.print("{}", tablesText(report, stages));
  context.print("{}", summaryText(report, build));
  Json json = reportJson(report, stages, build);
  if (inSteps) json["usage"] = stepUsage(options.steps.step);
  if (!report.refinement.steps.empty()) json["refinement"] = app::json(report.refinement);
  if (build.draft) {
    context.print("draft without cells: run the same command without --draft for the complete scene\n");
  } else {
    const Scene scene = loadScene(build.output);
    const CaptureAdvice advice = adviseCapture(scene);
    context.print("\n{}", adviceSummary(advice, build.output.string()));
    json["capture"] = adviceJson(scene, advice);
  }
  context.report(json);
  return kExitOk;
}

}  // namespace

const Command kBuildCommand{
    .name = "build",
    .summary = "Builds a scene from photographs",
    .examples =
        "ibr build photographs -o scene\n"
        "ibr build walk.mp4 -o scene\n"
        "ibr build photographs walk.mp4 -o scene\n"
        "ibr build photographs --model colmap/sparse/0 -o scene --max-size 1600\n"
        "ibr build photographs --model transforms.json -o scene\n"
        "ibr build photographs --model cameras.xml -o scene\n"
        "ibr build photographs -o scene --draft\n"
        "ibr build photographs -o scene --dry-run --json -\n"
        "ibr build photographs -o scene --memory 8G --threads 4\n"
        "ibr build photographs -o scene --masks masks\n"
        "ibr build photographs -o scene --matcher homographic --triangle-filter homogeneous\n"
        "ibr build photographs -o scene --refine-poses on\n"
        "ibr build photographs -o scene --steps\n"
        "ibr build photographs -o scene --step depth-0003\n"
        "ibr build photographs -o scene --exclude IMG_0007.jpg IMG_0015.jpg --json report.json",
    .details =
        "PHOTOS is a folder of photographs: JPEG, PNG, TIFF, HEIC, AVIF, WebP and raw (DNG, CR2,\n"
        "CR3, NEF, ARW and others: untested with a camera's file). Subfolders are searched, and\n"
        "links are followed. A video is decoded by the program ffmpeg: its frames are chosen by\n"
        "sharpness and by how far the camera has moved, not by time, and kept in SCENE/.photographs.\n\n"
        "--model takes the poses of the photographs in any of these formats, recognised by content:\n"
        "  COLMAP model (folder; text or binary; EQUIRECTANGULAR cameras for panoramas)\n"
        "  transforms.json of nerfstudio and instant-ngp; panoramas.json\n"
        "  Bundler (bundle.out, with list.txt beside it); VisualSFM (NVM_V3)\n"
        "  Metashape (cameras as XML; fisheye and spherical: untested with a real file)\n"
        "  RealityScan, RealityCapture: folder of XMP sidecars, or CSV of internal/external\n"
        "    camera parameters (lens distortion: untested with a real file)\n"
        "  OpenMVG (sfm_data.json): untested with a real file\n"
        "  OpenSfM, ODM (reconstruction.json, with tracks.csv; other than perspective cameras:\n"
        "    untested with a real file)\n"
        "A lens term that no lens of libibr has exactly is refused by name. Without poses, the\n"
        "program COLMAP estimates them in SCENE/.poses.\n"
        "Photographs of distorting lenses are undistorted; photographs of pinholes are stored\n"
        "unchanged. The same input, options and seed give the same scene.\n\n"
        "A stopped build resumes from the cached depth and cells in SCENE/.build. This folder may\n"
        "be deleted. After photographs are added, a build matches only what the new photographs\n"
        "change. COLMAP adds the new photographs to the poses in SCENE/.poses.\n\n"
        "--steps prints a JSON object: its field steps lists name, arguments (of ibr, to run the\n"
        "step), inputs (files that must exist before), output (the file that the step writes),\n"
        "seconds (predicted processor time) and memory (predicted, bytes). Steps may run at the\n"
        "same time, on all machines that share the folders, and may be repeated. The last step,\n"
        "scene, gives the same scene as one process. examples/cluster has a workflow for Snakemake\n"
        "and Slurm.",
    .afterInterrupt = "finished work is cached; run the same command again to resume",
    .mainOptions = "output model masks movers refine-poses draft exclude texture optimise dry-run",
    .declare = [](CLI::App& app) -> std::function<ExitCode(const Context&)> {
      const auto options = std::make_shared<Options>();
      addOption(app, "PHOTOS", options->photographs, "Folder of photographs, or a video; also several").required();
      addOption(app, "-o,--output", options->output, "Scene folder; created if missing").required().type("SCENE");
      declareBuildOptions(app, options->choices);
      addInt(app, "--video-frames", options->videoFrames, 2, 100000,
             "About how many frames of each video to use [40 to 80 a minute while the camera moves]");
      addFlag(app, "--dry-run", options->dryRun, "Only predict time, memory and disk space; build nothing");
      declareStepOptions(app, options->steps);
      afterParsing(app, [options, &app] { noteArguments(app, options->steps); });
      return [options](const Context& context) { return buildScene(*options, context); };
    }};

}  // namespace ibr::app
