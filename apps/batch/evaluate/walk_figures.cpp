// SPDX-License-Identifier: Apache-2.0
#include "batch/evaluate/walk_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "shared/report/statistics.h"

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

double meanOrNan(const std::vector<double>& values) {
  return values.empty() ? NAN : mean(values);
}

Json eyesJson(const EyeAgreement& eyes) {
  return {{"seenByBoth", eyes.seenByBoth},
          {"sameCell", eyes.sameCell},
          {"difference", eyes.difference},
          {"difference95", eyes.difference95}};
}

EyeAgreement meanOf(const std::vector<WalkFrame>& frames) {
  std::vector<double> seen, same, difference, difference95;
  for (const WalkFrame& frame : frames) {
    if (!frame.eyes) continue;
    seen.push_back(frame.eyes->seenByBoth);
    if (std::isnan(frame.eyes->difference)) continue;
    same.push_back(frame.eyes->sameCell);
    difference.push_back(frame.eyes->difference);
    difference95.push_back(frame.eyes->difference95);
  }
  return {meanOrNan(seen), meanOrNan(same), meanOrNan(difference), meanOrNan(difference95)};
}

}  // namespace

WalkSummary summaryOf(const std::vector<WalkFrame>& frames) {
  WalkSummary summary;
  std::vector<double> steps, flipSteps, inside;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const WalkFrame& frame = frames[i];
    if (!std::isnan(frame.step)) {
      steps.push_back(frame.step);
      summary.maxStep = std::fmax(summary.maxStep, frame.step);
      if (frame.switching) summary.maxStepAtSwitch = std::fmax(summary.maxStepAtSwitch, frame.step);
    }
    if (!std::isnan(frame.flipStep)) {
      flipSteps.push_back(frame.flipStep);
      if (frame.switching) summary.pop = std::fmax(summary.pop, frame.flipStep);
    }
    summary.switches += i > 0 && frame.mainCell != frames[i - 1].mainCell;
    summary.minCoverage = std::min(summary.minCoverage, frame.coverage);
    if (!std::isnan(frame.coverageInside)) inside.push_back(frame.coverageInside);
    for (std::size_t t = 0; t < summary.tier.size(); ++t) summary.tier[t] += frame.tier[t] / double(frames.size());
    if (frame.flicker > summary.flicker) {
      summary.flicker = frame.flicker;
      summary.flickerFrame = i;
      summary.flickerAt = frame.name;
    }
  }
  summary.medianStep = quantile(steps, 0.5);
  summary.medianFlipStep = quantile(flipSteps, 0.5);
  summary.meanCoverageInside = meanOrNan(inside);
  if (!inside.empty()) summary.minCoverageInside = std::ranges::min(inside);
  summary.eyes = meanOf(frames);
  return summary;
}

Json frameJson(const WalkFrame& frame) {
  Json json{{"name", frame.name},
            {"mainCell", frame.mainCell},
            {"switching", frame.switching},
            {"step", frame.step},
            {"flipStep", frame.flipStep},
            {"coverage", frame.coverage},
            {"coverageInside", frame.coverageInside},
            {"coverageTier", frame.tier},
            {"flicker", frame.flicker >= 0 ? Json(frame.flicker) : Json()}};
  if (frame.eyes) json["eyes"] = eyesJson(*frame.eyes);
  return json;
}

Json summaryJson(const WalkSummary& summary) {
  const bool held = summary.flicker >= 0;
  return {{"switches", summary.switches},
          {"medianStep", summary.medianStep},
          {"maxStep", summary.maxStep},
          {"maxStepAtSwitch", summary.maxStepAtSwitch},
          {"medianFlipStep", summary.medianFlipStep},
          {"pop", summary.pop},
          {"minCoverage", summary.minCoverage},
          {"minCoverageInside", summary.minCoverageInside},
          {"meanCoverageInside", summary.meanCoverageInside},
          {"coverageTier", summary.tier},
          {"flicker", held ? Json(summary.flicker) : Json()},
          {"flickerAt", held ? Json(summary.flickerAt) : Json()},
          {"flickerFrame", held ? Json(summary.flickerFrame) : Json()},
          {"eyes", std::isnan(summary.eyes.seenByBoth) ? Json() : eyesJson(summary.eyes)}};
}

Table summaryTable(const WalkSummary& summary, std::size_t frames) {
  Table table;
  const auto row = [&](const char* what, double value, int decimals) {
    if (!std::isnan(value)) table.row({what, numberText(value, decimals)});
  };
  table.row({"frames", std::to_string(frames)});
  table.row({"switches of the main cell", std::to_string(summary.switches)});
  row("median step, 8-bit levels", summary.medianStep, 3);
  row("largest step", summary.maxStep, 3);
  row("largest step at a switch", summary.maxStepAtSwitch, 3);
  row("  ratio to the median step", summary.maxStepAtSwitch / summary.medianStep, 2);
  row("median step, FLIP", summary.medianFlipStep, 4);
  row("pop (largest step at a switch), FLIP", summary.pop, 4);
  if (summary.flicker >= 0)
    table.row({"largest flicker of a still camera, 8-bit levels", std::to_string(summary.flicker)});
  if (summary.flicker > 0) table.row({"  at frame", fmt::format("{} ({})", summary.flickerFrame, summary.flickerAt)});
  row("minimum coverage", summary.minCoverage, 4);
  row("minimum coverage inside the photographs' views", summary.minCoverageInside, 4);
  row("mean coverage inside the photographs' views", summary.meanCoverageInside, 4);
  for (int t = 0; t < kTierCount; ++t)
    table.row({"tier " + std::to_string(t) + ", share", numberText(summary.tier[std::size_t(t)], 4)});
  row("visible to both eyes, share", summary.eyes.seenByBoth, 4);
  row("  from the same cell, share", summary.eyes.sameCell, 4);
  row("  mean difference, 8-bit levels", summary.eyes.difference, 3);
  row("  95 % quantile of the difference, 8-bit levels", summary.eyes.difference95, 2);
  return table;
}

}  // namespace ibr::app
