// SPDX-License-Identifier: Apache-2.0
// `ibr-lab sweep`: cost and benefit of the optimiser's settings ([T] §3.8.1, fig. 17).
// Difference: the paper plots time against ECC only; this command also compares rendered views with photographs.
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/check.h"
#include "base/file.h"
#include "batch/build/optimise_options.h"
#include "batch/command.h"
#include "batch/command_text.h"
#include "batch/files/measurement_cache.h"
#include "lab/lab_commands.h"
#include "lab/sweep/sweep_measure.h"
#include "shared/cli/options.h"
#include "shared/cli/progress.h"
#include "shared/cli/settings.h"
#include "shared/json/json_text.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  SweepOptions sweep;
  SweepLists lists;
  std::string output, command;
  bool list = false;
};

template <class T>
std::string joined(const std::vector<T>& values) {
  return fmt::format("{}", fmt::join(values, " "));
}

class Report {
 public:
  Report(const Options& options, const SweepMeasure& measure) : options_(options), folder_(options.output) {
    std::vector<std::string> views;
    for (const View& view : measure.views()) views.push_back(view.name);
    const EvaluationOptions& evaluation = options.sweep.evaluation;
    more_ = {{"scene", options.sweep.scene},
             {"truth", options.sweep.truth},
             {"views", views},
             {"cells", measure.cells()},
             {"evaluation", settingsJson(evaluation.settings, evaluation.gpuScene)},
             {"command", options.command}};
    notes_ = {fmt::format("Cells {} of {}; views {}.", joined(measure.cells()), options.sweep.scene, joined(views)),
              options.command};
  }

  Json json(const std::vector<SweepRow>& rows) const {
    Json more = more_;
    more["device"] = rows.empty() ? "" : rows.back().device;
    return sweepJson(rows, more);
  }

  void write(const std::vector<SweepRow>& rows) const {
    writeFile(folder_ / "sweep.csv", sweepCsv(rows));
    writeFile(folder_ / "sweep.json", jsonText(json(rows)));
    writeFile(folder_ / "sweep.svg", sweepSvg(rows, "Settings of the ECC optimiser", notes_));
  }

 private:
  const Options& options_;
  fs::path folder_;
  Json more_;
  std::vector<std::string> notes_;
};

std::optional<SweepRow> cachedRow(const MeasurementCache& kept, std::uint64_t key, const SweepSetting& setting) {
  const std::optional<Json> json = kept.find(key);
  if (!json) return std::nullopt;
  try {
    return rowOf(*json, setting);
  } catch (const Json::exception&) {
    return std::nullopt;  // damaged line: measured again
  }
}

// Measured rows, in the order of the settings.
std::vector<SweepRow> present(const std::vector<std::optional<SweepRow>>& rows) {
  std::vector<SweepRow> there;
  for (const auto& row : rows)
    if (row) there.push_back(*row);
  return there;
}

ExitCode sweep(const Options& options, const Context& context) {
  const std::vector<SweepSetting> settings = sweepSettings(options.lists, context.options().seed);
  if (options.list) {
    for (const SweepSetting& setting : settings) context.print("{}\n", setting.name());
    return kExitOk;
  }
  for (const fs::path& source : {fs::path(options.sweep.scene), fs::path(options.sweep.truth)})
    check(!isInside(options.output, source), ErrorCode::invalidInput,
          "--output {}: lies in {}, whose files identify cached measurements; choose another folder", options.output,
          source.string());
  SweepMeasure measure(options.sweep, context);
  makeFolders(options.output);
  MeasurementCache kept(fs::path(options.output) / "sweep.kept.jsonl");
  std::vector<std::optional<SweepRow>> rows(settings.size());
  std::vector<std::size_t> missing;
  for (std::size_t s = 0; s < settings.size(); ++s) {
    rows[s] = cachedRow(kept, measure.keyOf(settings[s]), settings[s]);
    if (!rows[s]) missing.push_back(s);
  }
  context.logMessage(LogLevel::info, "{} settings on cells {}; {} cached", settings.size(), joined(measure.cells()),
                     settings.size() - missing.size());
  const Report report(options, measure);
  {
    ProgressLine progress(context);
    for (std::size_t k = 0; k < missing.size(); ++k) {
      const SweepSetting& setting = settings[missing[k]];
      const auto show = [&](std::size_t part, std::size_t parts) {
        return progress.show({"measuring settings", k * parts + part, missing.size() * parts});
      };
      const SweepRow row = measure.measure(setting, [&](const Progress& part) { return show(part.done, part.total); });
      kept.add(measure.keyOf(setting), rowJson(row));
      rows[missing[k]] = row;
      report.write(present(rows));
      check(show(1, 1), ErrorCode::cancelled, "stopped");
    }
  }
  const std::vector<SweepRow> all = present(rows);
  report.write(all);
  context.print("{}\n{}\n", sweepTable(all), verdict(all));
  context.report(report.json(all));
  return kExitOk;
}

}  // namespace

const Command kSweepCommand{
    .name = "sweep",
    .summary = "Measures time, ECC and accuracy of held-out views for settings of the optimiser",
    .examples =
        "ibr-lab sweep scene --truth held-out -o swept\n"
        "ibr-lab sweep scene --truth held-out -o swept --views a.png b.png --method cpu gradient --prune\n"
        "ibr-lab sweep scene --truth held-out -o swept --method compute --radius 1 5 --rigidity 0 1 10 --decay 0.5\n"
        "ibr-lab sweep scene --truth held-out -o swept --grid --instances 32 64 128 --radius 5 20 --decay 0.5 1\n"
        "ibr-lab sweep scene --truth held-out -o swept --list",
    .details =
        "Each setting optimises the cells again in memory. Then the views are rendered and\n"
        "compared as in ibr eval, with --cells 1 and --tiers 0 unless other options are given.\n"
        "One number at a time is varied from the default, or all together with --grid. The folder\n"
        "gets sweep.csv, sweep.json and sweep.svg, which plots time against ECC and PSNR, and ECC\n"
        "against PSNR with their rank correlation. PSNR is that of covered pixels. Time is that\n"
        "of the optimisation, including reading photographs. Run nothing else on the machine\n"
        "during the measurement.",
    .afterInterrupt = "finished settings are cached; run the same command again to resume",
    .declare = [](CLI::App& app) -> std::function<ExitCode(const Context&)> {
      const auto options = std::make_shared<Options>();
      EvaluationOptions& evaluation = options->sweep.evaluation;
      addOption(app, "SCENE", options->sweep.scene, "Scene folder").required();
      addOption(app, "--truth", options->sweep.truth, "Held-out photographs with their poses").required().type("DIR");
      addOption(app, "-o,--output", options->output, "Folder for the measurements; created if missing")
          .required()
          .type("DIR");
      addOption(app, "--views", options->sweep.views, "Compare only these views, by name").type("NAME...");
      declareCellsOnly(app, options->sweep.cells, "Cells to optimise, by number [cells that the views show]");
      declareSweepLists(app, options->lists);
      addFlag(app, "--list", options->list, "Only list the settings");
      RenderSettings defaults;
      defaults.maxCells = 1;
      defaults.maxTier = kTierConsistent;
      declareAllSettings(app, evaluation.settings, defaults);
      declareGpuScene(app, evaluation.gpuScene);
      afterParsing(app, [options, &app] { options->command = commandText("ibr-lab sweep", givenArguments(app)); });
      return [options](const Context& context) { return sweep(*options, context); };
    }};

}  // namespace ibr::app
