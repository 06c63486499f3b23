// SPDX-License-Identifier: Apache-2.0
#include "lab/sweep/sweep_measure.h"

#include <ctime>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "base/check.h"
#include "batch/build/cell_figures.h"
#include "batch/build/optimise_options.h"
#include "batch/files/file_hash.h"
#include "shared/cli/settings.h"
#include "shared/json/json_text.h"

namespace ibr::app {
namespace {

constexpr std::size_t kParts = 100, kOptimiserParts = 90;  // steps of a setting's progress

std::vector<std::size_t> cellsShown(const Scene& scene, const std::vector<View>& views,
                                    const RenderSettings& settings) {
  const SceneBounds bounds = sceneBounds(scene);
  std::set<std::size_t> cells;
  for (const View& view : views)
    for (const PlannedCell& planned : planFrame(scene, bounds, {{view.camera}, settings}).cells)
      cells.insert(planned.cell);
  return {cells.begin(), cells.end()};
}

std::uint64_t keyOfAll(const SweepOptions& options, const Context& context) {
  Hash hash;
  addProgram(hash);
  addFolder(hash, options.scene);
  addFolder(hash, options.truth);
  for (const std::string& view : options.views) hash.add(view);
  for (const std::size_t cell : options.cells) hash.add(std::uint64_t(cell));
  hash.add(jsonLine(settingsJson(options.evaluation.settings, options.evaluation.gpuScene)));
  hash.add(context.options().device);
  hash.add(std::int64_t(context.options().threads));  // the measured time depends on the threads
  return hash.value();
}

// Measures the unchanged mesh: runs one cheap cycle on a copy, and uses only the values from before the cycle.
AlignmentSummary evaluateOnly(const Aligner& aligner, const Alignment& alignment, AlignmentOptions options,
                              const ProgressCallback& progress) {
  Alignment copy = alignment;
  options.maxCycles = 1;
  options.instances = 2;
  AlignmentSummary summary = aligner(copy, options, progress);
  summary.finalEcc = summary.initialEcc;
  summary.finalEccPaper = summary.initialEccPaper;
  summary.finalStarEcc = summary.initialStarEcc;
  summary.cycles.clear();
  summary.bestCycle = 0;
  return summary;
}

double cpuSeconds() {
  return double(std::clock()) / CLOCKS_PER_SEC;
}

}  // namespace

SweepMeasure::SweepMeasure(const SweepOptions& options, const Context& context)
    : options_(options),
      context_(context),
      scene_(loadScene(options.scene)),
      truth_(options.truth, options.views, context.log()),
      key_(0) {
  if (options_.cells.empty()) {
    options_.cells = cellsShown(scene_, truth_.views(), options.evaluation.settings);
    check(!options_.cells.empty(), ErrorCode::invalidInput, "{}: no cell is drawn in the views of {}", options.scene,
          options.truth);
  }
  for (const std::size_t cell : options_.cells)
    check(cell < scene_.cells.size(), ErrorCode::invalidInput,
          "there is no cell {} (--cells-only); the scene has {} cells", cell, scene_.cells.size());
  for (const View& view : truth_.views()) pictures_.push_back(truth_.picture(view));
  key_ = keyOfAll(options_, context);
}

std::uint64_t SweepMeasure::keyOf(const SweepSetting& setting) const {
  Hash hash;
  hash.add(key_);
  hash.add(setting.method());
  for (const SweepFactor& factor : sweepFactors()) hash.add(factor.get(setting.alignment));
  hash.add(setting.alignment.prune);
  hash.add(setting.alignment.seed);
  return hash.value();
}

const Aligner& SweepMeasure::alignerOf(AlignmentMethod method) {
  auto& aligner = aligners_[method];
  if (!aligner) aligner = makeAligner(method, context_);
  return aligner;
}

SweepRow SweepMeasure::measure(const SweepSetting& setting, const ProgressCallback& progress) {
  SweepRow row{.setting = setting};
  Scene scene = scene_;
  OptimiseCellsOptions cells{.alignment = setting.alignment,
                             .cells = options_.cells,
                             .threads = context_.options().threads,
                             .cacheFolder = {}};
  if (!setting.optimised) cells.alignment.method = AlignmentMethod::cpu;
  const Aligner& aligner = alignerOf(cells.alignment.method);
  const Aligner judge = [&](Alignment& alignment, const AlignmentOptions& options, const ProgressCallback& inner) {
    return evaluateOnly(aligner, alignment, options, inner);
  };
  const double begin = cpuSeconds();
  const OptimiseSceneReport report =
      optimiseCells(scene, cells, setting.optimised ? aligner : judge, [&](const Progress& p) {
        return progress({p.stage, p.total > 0 ? kOptimiserParts * p.done / p.total : 0, kParts});
      });
  if (setting.optimised) {
    row.seconds = report.seconds;
    row.cpuSeconds = cpuSeconds() - begin;
    for (const OptimisedCell& cell : report.cells) {
      row.mutations += double(sumOf(cell.summary.cycles).mutations);
      row.cycles = std::max(row.cycles, double(cell.summary.cycles.size()));
    }
  }
  row.ecc = meanOf(report, [](const OptimisedCell& c) { return c.summary.finalEcc; });
  row.eccPaper = meanOf(report, [](const OptimisedCell& c) { return c.summary.finalEccPaper; });

  // A new device is created for each setting, but its name is reported once.
  CommonOptions quietly = context_.options();
  quietly.quiet = quietly.quiet || std::exchange(rendered_, true);
  const Context context(quietly);
  Evaluator evaluator(scene, views(), options_.evaluation, context);
  std::vector<Scores> all;
  for (std::size_t v = 0; v < pictures_.size(); ++v) {
    check(progress({"comparing", kOptimiserParts, kParts}), ErrorCode::cancelled, "stopped");
    all.push_back(evaluator.evaluate(views()[v], pictures_[v]).scores);
  }
  row.scores = meanOf(all);
  row.device = evaluator.deviceName();
  return row;
}

}  // namespace ibr::app
