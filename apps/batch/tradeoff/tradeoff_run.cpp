// SPDX-License-Identifier: Apache-2.0
#include "batch/tradeoff/tradeoff_run.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>

#include "base/check.h"
#include "base/file.h"
#include "base/hash.h"
#include "batch/command_text.h"
#include "batch/files/measurement_cache.h"
#include "batch/tradeoff/tradeoff_html.h"
#include "ibr/metrics.h"
#include "ibr/texture.h"
#include "shared/cli/presets.h"
#include "shared/cli/progress.h"
#include "shared/cli/signals.h"
#include "shared/draw/image_operations.h"
#include "shared/json/json_text.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kReferenceViews = 2;  // number of views for the reference implementation, which is slow

std::vector<TradeoffWalk> walksOf(TradeoffRenderer& stage, const std::vector<TradeoffSetting>& settings,
                                  const std::vector<View>& walk, std::uint64_t key, MeasurementCache& kept,
                                  ProgressLine& progress) {
  std::vector<TradeoffWalk> walks;
  for (std::size_t p = 0; p < kPresets.size() && !walk.empty(); ++p) {
    Hash hash;
    hash.add(key);
    hash.add(std::string("walk ") + kPresets[p].first);
    const std::optional<Json> json = kept.find(hash.value());
    try {
      if (json) {
        walks.push_back(walkOf(*json));
        continue;
      }
    } catch (const Json::exception&) {  // damaged line: walked again
    }
    walks.push_back(measureWalk(stage, kPresets[p].first, settings[p].variant, walk, [&] {
      check(progress.show({"walking", p, kPresets.size()}), ErrorCode::cancelled, "stopped");
    }));
    kept.add(hash.value(), walkJson(walks.back()));
  }
  return walks;
}

// Finds the worst view of each preset, against the truth, or against the reference preset if there is no truth.
std::vector<WorstView> worstViews(TradeoffRenderer& stage, const std::vector<TradeoffRow>& rows,
                                  const std::vector<TradeoffSubject>& subjects) {
  std::vector<WorstView> worst;
  for (std::size_t p = 0; p < kPresets.size(); ++p) {
    const auto flipOf = [](const TradeoffView& view) {
      return std::isfinite(view.truth.flip) ? view.truth.flip : view.reference.flip;
    };
    if (!rows[p].failure.empty()) continue;
    const std::vector<TradeoffView>& views = rows[p].views;
    const std::size_t v = std::size_t(std::ranges::max_element(views, {}, flipOf) - views.begin());
    const Camera& camera = subjects[v].view.camera;
    const Image8 picture = stage.picture(rows[p].setting.variant, camera);
    const Image8& truth = subjects[v].truth;
    const Image8 other = truth.empty() ? stage.picture(rows[kReferenceSetting].setting.variant, camera) : truth;
    worst.push_back(
        {kPresets[p].first, views[v].name, flipOf(views[v]), rgb(picture), rgb(other), flipPicture(picture, other)});
  }
  return worst;
}

// Mean over the views with a truth; NaN if there is none.
double sampledDetailOf(const std::vector<TradeoffSubject>& subjects) {
  double sum = 0;
  int count = 0;
  for (const TradeoffSubject& subject : subjects)
    if (!subject.truth.empty()) sum += sampledDetail(subject.truth), ++count;
  return sum / count;
}

// Errors of colour tables, on the first photograph with a texture.
std::vector<MapError> mapErrorsOf(const Scene& scene, std::uint64_t seed) {
  for (const Node& node : scene.nodes)
    if (!node.textureFile.empty())
      return mapErrors(decodeTexture(readKtx2(scene.folder / node.textureFile, 0))[0], seed);
  return {};
}

// Settings that this report does not vary, with the reasons.
std::vector<std::string> missingKnobs(const TradeoffOptions& options, const Scene& scene) {
  std::vector<std::string> missing;
  if (options.sweep.empty())
    missing.emplace_back(
        "settings M, R, D and t of the optimiser: measure these with ibr-lab sweep, then give its report with --sweep "
        "FILE");
  if (options.builds.empty())
    missing.emplace_back(
        "mesh density: build the scene with other options, then give these builds with --build NAME=SCENE");
  if (!hasPlainTextures(scene))
    missing.emplace_back(
        "texture formats: the scene's textures are block-compressed; to compare formats, build the scene with "
        "--texture rgba8");
  missing.emplace_back("precision of the ECC: there is no setting, because sums are exact on every device");
  missing.emplace_back("texture coordinate complements: only harmonised models have these (ibr htm eval)");
  return missing;
}

// Measures all settings on the scene and its builds.
TradeoffReport measuredReport(const TradeoffOptions& options, const TradeoffBuilds& builds,
                              const std::vector<TradeoffSubject>& subjects, const std::vector<View>& walk,
                              const TradeoffSettings& settings, TradeoffRenderer& stage, const Context& context) {
  MeasurementCache kept(fs::path(options.output) / "tradeoff.kept.jsonl");
  const std::uint64_t key = tradeoffKey(options, builds, subjects, stage.device(), context);
  TradeoffReport report;
  report.knobs = settings.knobs;
  report.about = tradeoffAbout(options, builds, subjects, stage.device(), context);
  {
    ProgressLine progress(context);
    TradeoffMeasure measure(stage, subjects, {options.repeat, context.options().seed, key}, kept);
    report.rows = measure.measure(settings.all, [&](std::size_t done, std::size_t total) {
      check(progress.show({"measuring", done, total}), ErrorCode::cancelled, "stopped");
    });
    if (measure.found() > 0)
      context.logMessage(LogLevel::info, "{} of {} measurements are cached", measure.found(),
                         settings.all.size() + std::size_t(options.repeat));
    std::vector<View> first;
    for (std::size_t v = 0; v < std::min(kReferenceViews, subjects.size()); ++v) first.push_back(subjects[v].view);
    report.implementation = implementationErrors(stage, first, [&] { stopIfInterrupted(); });
    report.walks = walksOf(stage, settings.all, walk, key, kept, progress);
  }
  report.mapErrors = mapErrorsOf(builds.scenes[0], context.options().seed);
  report.sampledDetail = sampledDetailOf(subjects);
  report.missing = missingKnobs(options, builds.scenes[0]);
  return report;
}

// Writes the report to the folder in all formats, and prints its tables.
void writeReport(const TradeoffReport& report, const std::vector<TradeoffFigure>& figures,
                 const std::vector<WorstView>& worst, const fs::path& folder, const Context& context) {
  writeFile(folder / "report.html", tradeoffHtml(report, figures, worst, folder));
  const Json json = reportJson(report);
  writeFile(folder / "tradeoff.json", jsonText(json));
  writeFile(folder / "tradeoff.csv", tradeoffCsv(report.rows));
  context.print("{}", reportText(report));
  context.report(json);
}

}  // namespace

ExitCode runTradeoff(const TradeoffOptions& options, const Context& context) {
  const nlohmann::ordered_json sweep = readSweepReport(options.sweep);
  const TradeoffBuilds builds = loadTradeoffBuilds(options);
  const TradeoffSettings settings = tradeoffSettings({deviceKindFor(context.options().device), options.knobs,
                                                      options.grid, hasPlainTextures(builds.scenes[0]), builds.names});
  if (options.list) {
    for (const TradeoffSetting& setting : settings.all) context.print("{}\n", setting.name());
    return kExitOk;
  }
  for (const std::string& source : builds.folders)
    check(!isInside(options.output, source), ErrorCode::invalidInput,
          "--output {}: lies in {}, whose files identify cached measurements; choose another folder", options.output,
          source);
  const std::vector<TradeoffSubject> subjects = tradeoffSubjects(options, builds.scenes[0], context);
  const std::vector<View> walk = tradeoffWalk(options, builds.scenes[0], subjects);
  TradeoffRenderer stage(builds.scenes, maxExtentOf(subjects, walk), context);
  makeFolders(options.output);
  const TradeoffReport report = measuredReport(options, builds, subjects, walk, settings, stage, context);
  const std::vector<TradeoffFigure> figures = tradeoffFigures(report, sweep);
  for (const TradeoffFigure& figure : figures) writeFile(fs::path(options.output) / figure.file, figure.svg);
  writeReport(report, figures, worstViews(stage, report.rows, subjects), options.output, context);
  const std::vector<TradeoffGate> gates = presetGates(report.rows);
  const bool beaten = std::ranges::any_of(gates, [](const TradeoffGate& gate) { return gate.counted && !gate.holds; });
  return options.check && beaten ? kExitComparison : kExitOk;
}

}  // namespace ibr::app
