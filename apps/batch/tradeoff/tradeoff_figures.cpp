// SPDX-License-Identifier: Apache-2.0
#include "batch/tradeoff/tradeoff_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "shared/cli/presets.h"
#include "shared/report/bars.h"
#include "shared/report/plot.h"
#include "shared/report/statistics.h"

namespace ibr::app {
namespace {

bool drawn(const TradeoffRow& row) {
  return row.failure.empty() && row.setting.variant.build == 0;
}

std::string formatOf(const TradeoffRow& row) {
  return row.setting.variant.texture ? fmt::format("textures {}", textureFormatName(*row.setting.variant.texture))
                                     : "textures as stored";
}

const char* errorName(const TradeoffReport& report) {
  return std::isfinite(report.rows[kDefaultSetting].truth().flip) ? "mean FLIP against the truth"
                                                                  : "mean FLIP against the reference preset";
}

std::string subtitle(const TradeoffReport& report) {
  return fmt::format("{}; {} rounds; {}", report.about.value("device", ""), report.about.value("repeat", 0),
                     report.about.value("command", ""));
}

// Scale of a marker, whose area grows with the memory.
double sizeOf(double bytes, double most) {
  return 0.5 + std::sqrt(bytes / most);
}

// Legend of the smallest and the largest marker.
PlotWords wordsOf(const TradeoffReport& report, const std::string& joined) {
  double least = INFINITY, most = 0;
  for (const TradeoffRow& row : report.rows)
    if (drawn(row)) {
      least = std::min(least, double(row.bytes()));
      most = std::max(most, double(row.bytes()));
    }
  PlotWords words{"preset", joined, {}, ""};
  for (const double bytes : {least, most})
    if (most > 0) words.sizes.emplace_back(sizeOf(bytes, most), fmt::format("{:.1f} MiB", bytes / 1048576));
  return words;
}

// One point for each setting; series by texture format. Presets and points of the front are labelled.
template <class X, class Y>
PlotPanel panelOf(const TradeoffReport& report, X x, Y y, bool quartiles = false) {
  PlotPanel panel;
  const std::vector<std::size_t> front = timeFront(report.rows);
  double most = 0;
  for (const TradeoffRow& row : report.rows)
    if (drawn(row)) most = std::max(most, double(row.bytes()));
  for (std::size_t i = 0; i < report.rows.size(); ++i) {
    const TradeoffRow& row = report.rows[i];
    if (!drawn(row) || row.setting.variant.views != 1) continue;
    auto series = std::ranges::find(panel.series, formatOf(row), &PlotSeries::name);
    if (series == panel.series.end()) series = panel.series.insert(series, {formatOf(row), {}});
    const bool preset = i < kPresets.size();
    PlotPoint point{x(row), y(row), row.setting.name(), preset};
    if (preset)
      point.label = kPresets[i].first;
    else
      point.labelled = std::ranges::find(front, i) != front.end();
    if (quartiles) {
      point.low = row.quantileMs(0.25);
      point.high = row.quantileMs(0.75);
    }
    point.size = sizeOf(double(row.bytes()), most);
    series->points.push_back(point);
  }
  panel.width = 640;
  return panel;
}

// True if the values span at least `factor`, so that a logarithmic axis suits them.
bool spanAFactor(const PlotPanel& panel, double factor) {
  double least = INFINITY, most = 0;
  for (const PlotSeries& series : panel.series)
    for (const PlotPoint& point : series.points) {
      least = std::min(least, point.y);
      most = std::max(most, point.y);
    }
  return least > 0 && most >= factor * least;
}

TradeoffFigure pareto(const TradeoffReport& report) {
  PlotPanel panel = panelOf(
      report, [](const TradeoffRow& row) { return row.medianMs(); }, errorOf, true);
  panel.title = "Time and error";
  panel.xName = "median time of a frame, ms";
  panel.yName = errorName(report);
  panel.logarithmicX = panel.joinAll = panel.lowerIsBetter = true;
  panel.logarithmicY = spanAFactor(panel, 2);
  PlotWords words = wordsOf(report, "line: Pareto front of time and error");
  words.interval = "interquartile range of the rounds";
  return {"pareto.svg",
          "Each marker is a setting: median frame time with the interquartile range of the rounds, and error. Larger "
          "markers take more memory. Rings: presets.",
          plotSvg("Frame time and error of the settings", {panel}, {subtitle(report)}, words)};
}

TradeoffFigure memory(const TradeoffReport& report) {
  const bool truth = std::isfinite(report.rows[kDefaultSetting].truth().psnr);
  PlotPanel panel = panelOf(
      report, [](const TradeoffRow& row) { return double(row.bytes()) / 1048576; },
      [truth](const TradeoffRow& row) { return truth ? row.truth().psnr : row.reference().psnr; });
  panel.title = "Memory and PSNR";
  panel.xName = "device memory, MiB";
  panel.yName = truth ? "PSNR against the truth, dB" : "PSNR against the reference preset, dB";
  panel.logarithmicX = panel.joinAll = true;
  return {"memory.svg", "Memory is the sum of positions, indices, textures and working images.",
          plotSvg("Memory and accuracy of the settings", {panel}, {subtitle(report)},
                  wordsOf(report, "line: Pareto front of memory and PSNR"))};
}

TradeoffFigure tornado(const TradeoffReport& report) {
  std::vector<TornadoRow> rows;
  for (const TradeoffKnob& knob : report.knobs) {
    const TradeoffRow& base = report.rows[knob.base];
    TornadoRow line{knob.name, {}};
    for (const TradeoffRow& row : report.rows)
      if (const std::string* value = row.setting.valueOf(knob.name); value && row.failure.empty())
        line.marks.push_back({*value, {row.medianMs() / base.medianMs(), errorOf(row) - errorOf(base)}});
    rows.push_back(std::move(line));
  }
  return {
      "knobs.svg",
      "One knob at a time is varied from a base. The base is the default setting; for photographs, colours, layers and "
      "voteScale it is gathered; for knobs of cells it draws cells; for knobs of colour tables it draws cells with "
      "colour mapping; for eyeColours it also has two views. Left: time relative to the base. Right: error minus the "
      "error of the base; markers left of the line are better.",
      tornadoSvg("Time and error of each knob",
                 {{"frame time, relative to the base", 1, true}, {fmt::format("change of {}", errorName(report)), 0}},
                 rows)};
}

TradeoffFigure passes(const TradeoffReport& report) {
  std::vector<StackedBar> bars;
  const auto add = [&](const TradeoffRow& row, const std::string& name) {
    if (!row.failure.empty() || row.deviceMs.empty()) return;
    StackedBar bar{name, {}};
    std::vector<double> plan;
    for (const std::vector<double>& round : row.planMs) plan.push_back(mean(round));
    bar.parts.push_back({"plan (CPU)", quantile(plan, 0.5)});
    for (const auto& [pass, milliseconds] : row.passMs) bar.parts.push_back({pass, quantile(milliseconds, 0.5)});
    bars.push_back(std::move(bar));
  };
  for (std::size_t p = 0; p < kPresets.size(); ++p) add(report.rows[p], kPresets[p].first);
  for (const TradeoffRow& row : report.rows)
    for (const char* knob : {"colour", "order", "tiers", "filter"})
      if (const std::string* value = row.setting.valueOf(knob); value && row.setting.name() != "preset balanced")
        add(row, fmt::format("{} {}", knob, *value));
  return {"passes.svg", "Median times of the parts of a frame. On a software device, parts overlap slightly.",
          stackedSvg("Time of the parts of a frame", bars, " ms")};
}

TradeoffFigure optimiser(const nlohmann::ordered_json& sweep) {
  PlotPanel time, ecc;
  time.title = "Time and held-out PSNR";
  time.xName = ecc.xName = "optimisation time, s";
  time.yName = "PSNR of held-out views, covered, dB";
  ecc.title = "Time and ECC";
  ecc.yName = "mean ECC, optimised";
  for (PlotPanel* panel : {&time, &ecc}) panel->logarithmicX = panel->joinFront = true;
  const auto number = [](const nlohmann::ordered_json& json) {
    return json.is_number() ? json.get<double>() : std::nan("");
  };
  for (const nlohmann::ordered_json& row : sweep.at("settings")) {
    const std::string method = row.at("method"), name = row.at("setting");
    const double psnr = number(row.at("scores").at("psnrCovered")), found = number(row.at("ecc"));
    if (method == "none") {
      time.levels.push_back({name, psnr});
      ecc.levels.push_back({name, found});
      continue;
    }
    for (const auto& [panel, y] : {std::pair{&time, psnr}, {&ecc, found}}) {
      auto series = std::ranges::find(panel->series, method, &PlotSeries::name);
      if (series == panel->series.end()) series = panel->series.insert(series, {method, {}});
      series->points.push_back({number(row.at("seconds")), y, name.substr(std::min(name.size(), method.size() + 1)),
                                row.value("default", false)});
    }
  }
  return {"optimiser.svg", sweep.value("verdict", ""), plotSvg("Settings of the optimiser", {time, ecc}, {})};
}

TradeoffFigure histogram(const TradeoffReport& report) {
  PlotPanel panel{.title = "Colour tables from few pixels",
                  .xName = "counted pixels",
                  .yName = "mean error of the table, 8-bit levels"};
  panel.logarithmicX = true;
  PlotSeries same{"both histograms of the same pixels", {}}, apart{"histograms of independently chosen pixels", {}};
  for (const MapError& error : report.mapErrors) {
    same.points.push_back({double(error.samples), error.same, ""});
    apart.points.push_back({double(error.samples), error.apart, ""});
  }
  panel.series = {same, apart};
  return {"histogram.svg",
          "Error of the colour table that colour mapping computes for a photograph changed by a known curve.",
          plotSvg("Errors of colour tables", {panel}, {}, {"", "", {}, ""})};
}

}  // namespace

std::vector<TradeoffFigure> tradeoffFigures(const TradeoffReport& report, const nlohmann::ordered_json& sweep) {
  std::vector<TradeoffFigure> figures{pareto(report), tornado(report), memory(report)};
  if (!sweep.is_null()) figures.push_back(optimiser(sweep));
  figures.push_back(passes(report));
  if (!report.mapErrors.empty()) figures.push_back(histogram(report));
  return figures;
}

}  // namespace ibr::app
