// SPDX-License-Identifier: Apache-2.0
#include "batch/bench/bench_report.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "shared/cli/settings.h"
#include "shared/report/statistics.h"

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) {
  return std::isnan(value) ? Json(nullptr) : Json(value);
}

}  // namespace

Option declareBenchRun(CLI::App& app, BenchRun& run) {
  addInt(app, "--views", run.views, 1, 1000, "Number of views along an automatic path");
  addInt(app, "--repeat", run.wanted.repeat, 1, 10'000, "Number of frames for each method and view");
  const Option stereo = addFlag(app, "--stereo", run.wanted.stereo, "Also measure two views, 64 mm apart");
  RenderSettings defaults;  // for the fields of the compared cells
  defaults.maxTier = kTierFilled;
  declarePictureSettings(app, run.wanted.settings, defaults);
  declareGpuScene(app, run.gpuScene);
  return stereo;
}

BenchReport::BenchReport() {
  table_.row({"scene", "cells", "drawn", "triangles", "method", "colour", "blend", "views", "median ms", "p95 ms",
              "/ paper", "/ unmapped", "/ two", "/ whole"});
}

void BenchReport::add(const std::string& scene, const RenderSettings& settings, const BenchResult& result) {
  for (const VariantTimes& times : result.ways) {
    const BenchVariant& way = times.way;
    const double median = quantile(times.milliseconds, 0.5), p95 = quantile(times.milliseconds, 0.95);
    const double ratioToPaper = quantile(times.ratioToPaper, 0.5),
                 ratioToUnmapped = quantile(times.ratioToUnmapped, 0.5);
    const double ratioToTwoMono = quantile(times.ratioToTwoMono, 0.5),
                 ratioToWithoutMask = quantile(times.ratioToWithoutMask, 0.5);
    const Json which{{"scene", scene},
                     {"cells", settings.maxCells},
                     {"drawn", result.drawn},
                     {"triangles", result.triangles},
                     {"way", way.name},
                     {"composition", optionValue(compositionOf(way, settings))},
                     {"colourMapping", optionValue(way.colour)},
                     {"blend", optionValue(way.blend)},
                     {"views", way.views},
                     {"hiddenCorners", way.hidden}};
    Json frame = which;
    frame.update({{"medianMs", median},
                  {"p95Ms", p95},
                  {"n", times.milliseconds.size()},
                  {"ratioToPaper", number(ratioToPaper)},
                  {"ratioToUnmapped", number(ratioToUnmapped)},
                  {"ratioToTwoMono", number(ratioToTwoMono)},
                  {"ratioToWhole", number(ratioToWithoutMask)}});
    frames_.push_back(frame);
    for (const auto& [name, milliseconds] : times.passes) {
      Json pass = which;
      pass.update({{"pass", name},
                   {"medianMs", quantile(milliseconds, 0.5)},
                   {"p95Ms", quantile(milliseconds, 0.95)},
                   {"n", milliseconds.size()}});
      passes_.push_back(pass);
    }
    table_.row({scene, std::to_string(settings.maxCells), std::to_string(result.drawn),
                std::to_string(result.triangles), way.name, optionValue(way.colour), optionValue(way.blend),
                std::to_string(way.views), numberText(median, 1), numberText(p95, 1), numberText(ratioToPaper, 3),
                numberText(ratioToUnmapped, 3), numberText(ratioToTwoMono, 3), numberText(ratioToWithoutMask, 3)});
  }
}

void BenchReport::print(const Context& context, const Device& device, const BenchRun& run,
                        const std::string& scene) const {
  context.print("{}", table_.text());
  const bool software = device.kind() == DeviceKind::software;
  context.report(Json{
      {"device", device.name()},
      {"size", {run.size.width, run.size.height}},
      {"frames", frames_},
      {"passes", passes_},
      {"passTimes", software ? "timestamps within one submission of a software device; the passes add up to the frame"
                             : "device timestamps"},
      {"settings", settingsJson(run.wanted.settings, run.gpuScene)},
      {"scene", scene}});
}

}  // namespace ibr::app
