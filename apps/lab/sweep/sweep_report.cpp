// SPDX-License-Identifier: Apache-2.0
#include "lab/sweep/sweep_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "shared/report/plot.h"
#include "shared/report/rank.h"
#include "shared/report/table.h"

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

struct Figure {
  const char* name;     // in JSON and CSV
  const char* heading;  // of the table
  int decimals;
  double SweepRow::*value;
};
constexpr Figure kFigures[] = {{"seconds", "s", 2, &SweepRow::seconds},
                               {"processorSeconds", "CPU s", 2, &SweepRow::cpuSeconds},
                               {"mutations", "mutations", 0, &SweepRow::mutations},
                               {"cycles", "cycles", 0, &SweepRow::cycles},
                               {"ecc", "ECC", 4, &SweepRow::ecc},
                               {"eccPaper", "ECC (paper)", 4, &SweepRow::eccPaper}};

struct Score {
  const char* name;
  const char* heading;
  int decimals;
  double Scores::*value;
};
constexpr Score kScores[] = {{"psnrCovered", "PSNR covered", 3, &Scores::psnrCovered},
                             {"ssimCovered", "SSIM covered", 4, &Scores::ssimCovered},
                             {"psnr", "PSNR", 3, &Scores::psnr},
                             {"ssim", "SSIM", 4, &Scores::ssim},
                             {"coverage", "coverage", 4, &Scores::coverage}};

constexpr std::size_t kMinSettingsForVerdict = 5;  // minimum number of settings: fewer may be in order by chance

// Formats all digits, unlike numberText; empty if the value is not finite.
std::string csvText(double value) {
  return std::isfinite(value) ? fmt::format("{}", value) : "";
}

double numberOrNan(const Json& json, const char* name) {
  const Json& value = json.at(name);
  return value.is_null() ? std::nan("") : value.get<double>();
}

std::vector<std::string> methodsOf(const std::vector<SweepRow>& rows) {
  std::vector<std::string> methods;
  for (const SweepRow& row : rows)
    if (row.setting.optimised && std::ranges::find(methods, row.setting.method()) == methods.end())
      methods.push_back(row.setting.method());
  return methods;
}

std::size_t measured(const std::vector<SweepRow>& rows) {
  return std::size_t(std::ranges::count_if(rows, [](const SweepRow& row) {
    return row.setting.optimised && std::isfinite(row.ecc) && std::isfinite(row.scores.psnrCovered);
  }));
}

double psnrOf(const SweepRow& row) {
  return row.scores.psnrCovered;
}

using Value = double (*)(const SweepRow&);

PlotPanel panelOf(const std::vector<SweepRow>& rows, Value x, Value y) {
  PlotPanel panel;
  for (const std::string& method : methodsOf(rows)) {
    PlotSeries series{method, {}};
    for (const SweepRow& row : rows)
      if (row.setting.method() == method)
        series.points.push_back({x(row), y(row), row.setting.label, row.setting.usual});
    panel.series.push_back(std::move(series));
  }
  return panel;
}

PlotPanel timePanel(const std::vector<SweepRow>& rows, const char* title, const char* name, Value y) {
  PlotPanel panel = panelOf(
      rows, [](const SweepRow& row) { return row.seconds; }, y);
  panel.title = title;
  panel.xName = "time, s";
  panel.yName = name;
  panel.logarithmicX = panel.joinFront = true;
  for (const SweepRow& row : rows)
    if (!row.setting.optimised) panel.levels.push_back({row.setting.label, y(row)});
  return panel;
}

}  // namespace

Json rowJson(const SweepRow& row) {
  Json json{{"setting", row.setting.name()}, {"method", row.setting.method()}, {"default", row.setting.usual}};
  for (const SweepFactor& factor : sweepFactors())
    json[factor.name] = row.setting.optimised ? Json(factor.get(row.setting.alignment)) : Json();
  json["prune"] = row.setting.optimised ? Json(row.setting.alignment.prune) : Json();
  for (const Figure& figure : kFigures) json[figure.name] = row.*figure.value;
  json["scores"] = scoresJson(row.scores);
  json["device"] = row.device;
  return json;
}

SweepRow rowOf(const Json& json, const SweepSetting& setting) {
  SweepRow row{.setting = setting, .scores = scoresOf(json.at("scores")), .device = json.at("device")};
  for (const Figure& figure : kFigures) row.*figure.value = numberOrNan(json, figure.name);
  return row;
}

double rankCorrelation(const std::vector<SweepRow>& rows, const std::string& method) {
  std::vector<double> ecc, psnr;
  for (const SweepRow& row : rows) {
    if (!row.setting.optimised || (!method.empty() && row.setting.method() != method)) continue;
    ecc.push_back(row.ecc);
    psnr.push_back(psnrOf(row));
  }
  return spearman(ecc, psnr);
}

std::string verdict(const std::vector<SweepRow>& rows) {
  const double rho = rankCorrelation(rows);
  const std::string question = "Does ECC predict PSNR? ";
  if (std::isnan(rho) || measured(rows) < kMinSettingsForVerdict)
    return question + "There are too few different settings to answer.";
  const char* answer = rho >= 0.7   ? "Yes"
                       : rho >= 0.3 ? "Partly"
                       : rho > -0.3 ? "No"
                       : rho > -0.7 ? "No, weakly the opposite"
                                    : "No, the opposite";
  std::string each;
  const auto methods = methodsOf(rows);
  for (std::size_t m = 0; methods.size() > 1 && m < methods.size(); ++m)
    each += fmt::format("{}{} {}", m == 0 ? "; " : ", ", methods[m], numberText(rankCorrelation(rows, methods[m]), 2));
  return fmt::format("{}{}: Spearman's rho = {:.2f} over {} settings{}.", question, answer, rho, measured(rows), each);
}

std::string sweepTable(const std::vector<SweepRow>& rows) {
  Table table;
  std::vector<std::string> heading{"setting"};
  for (const Figure& figure : kFigures) heading.push_back(figure.heading);
  for (const Score& score : kScores) heading.push_back(score.heading);
  table.row(std::move(heading));
  for (const SweepRow& row : rows) {
    std::vector<std::string> line{row.setting.name()};
    for (const Figure& figure : kFigures) line.push_back(numberText(row.*figure.value, figure.decimals));
    for (const Score& score : kScores) line.push_back(numberText(row.scores.*score.value, score.decimals));
    table.row(std::move(line));
  }
  return table.text();
}

std::string sweepCsv(const std::vector<SweepRow>& rows) {
  std::string csv = "setting,method,default";
  for (const SweepFactor& factor : sweepFactors()) csv += fmt::format(",{}", factor.name);
  csv += ",prune";
  for (const Figure& figure : kFigures) csv += fmt::format(",{}", figure.name);
  for (const Score& score : kScores) csv += fmt::format(",{}", score.name);
  csv += '\n';
  for (const SweepRow& row : rows) {
    const SweepSetting& setting = row.setting;
    csv += fmt::format("{},{},{:d}", setting.name(), setting.method(), setting.usual);
    for (const SweepFactor& factor : sweepFactors())
      csv += "," + (setting.optimised ? csvText(factor.get(setting.alignment)) : "");
    csv += setting.optimised ? fmt::format(",{:d}", setting.alignment.prune) : ",";
    for (const Figure& figure : kFigures) csv += "," + csvText(row.*figure.value);
    for (const Score& score : kScores) csv += "," + csvText(row.scores.*score.value);
    csv += '\n';
  }
  return csv;
}

Json sweepJson(const std::vector<SweepRow>& rows, const Json& more) {
  Json json{{"settings", Json::array()}, {"spearman", {{"all", rankCorrelation(rows)}}}, {"verdict", verdict(rows)}};
  for (const SweepRow& row : rows) json["settings"].push_back(rowJson(row));
  for (const std::string& method : methodsOf(rows)) json["spearman"][method] = rankCorrelation(rows, method);
  json.update(more);
  return json;
}

std::string sweepSvg(const std::vector<SweepRow>& rows, const std::string& title,
                     const std::vector<std::string>& notes) {
  const Value ecc = [](const SweepRow& row) { return row.ecc; };
  const char *eccName = "mean ECC, optimised", *psnrName = "PSNR of held-out views, covered, dB";
  PlotPanel both = panelOf(rows, ecc, psnrOf);
  both.title = "ECC and PSNR";
  both.xName = eccName;
  both.yName = psnrName;
  for (const SweepRow& row : rows)
    if (!row.setting.optimised) both.levels.push_back({"unoptimised", psnrOf(row)});
  std::vector<std::string> lines{verdict(rows)};
  lines.insert(lines.end(), notes.begin(), notes.end());
  return plotSvg(
      title, {timePanel(rows, "Time and ECC", eccName, ecc), timePanel(rows, "Time and PSNR", psnrName, psnrOf), both},
      lines);
}

}  // namespace ibr::app
