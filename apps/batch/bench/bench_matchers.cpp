// SPDX-License-Identifier: Apache-2.0
#include "batch/bench/bench_matchers.h"

#include <cmath>
#include <filesystem>

#include "base/check.h"
#include "ibr/matchers.h"
#include "io/image_file.h"
#include "shared/cli/progress.h"
#include "shared/report/table.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

std::string nameOf(const MatchScore& score) {
  return std::string(methodName(score.method)) + (score.filter == TriangleFilter::homogeneous ? ", homogeneous" : "");
}

struct Figure {
  const char* name;
  const char* heading;
  int decimals;
  double (*value)(const MatchScore&);
};
constexpr Figure kFigures[] = {{"vertices", "vertices", 0, [](const MatchScore& s) { return double(s.vertices); }},
                               {"medianPx", "median px", 3, [](const MatchScore& s) { return s.medianPx; }},
                               {"within1Px", "< 1 px", 3, [](const MatchScore& s) { return s.within1Px; }},
                               {"beyond3Px", "> 3 px", 3, [](const MatchScore& s) { return s.beyond3Px; }},
                               {"kept", "kept", 3, [](const MatchScore& s) { return s.kept; }},
                               {"precision", "precision", 3, [](const MatchScore& s) { return s.precision; }},
                               {"coverage", "coverage", 3, [](const MatchScore& s) { return s.coverage; }},
                               {"memberPsnr", "member dB", 1, [](const MatchScore& s) { return s.memberPsnr; }},
                               {"ecc", "ECC", 3, [](const MatchScore& s) { return s.ecc; }},
                               {"homogeneous", "homogeneous", 3, [](const MatchScore& s) { return s.homogeneous; }},
                               {"cpuSeconds", "CPU s", 1, [](const MatchScore& s) { return s.cpuSeconds; }}};

}  // namespace

Json benchMatchers(const MatcherBench& bench, const Context& context) {
  const fs::path data = bench.data.empty() ? fs::path(bench.cases).parent_path() : fs::path(bench.data);
  const std::vector<MatchCase> cases = readMatchCases(bench.cases, data);
  if (!bench.pictures.empty()) fs::create_directories(bench.pictures);
  Table table;
  std::vector<std::string> heading{"case", "method"};
  for (const Figure& figure : kFigures) heading.push_back(figure.heading);
  table.row(std::move(heading));
  Json rows = Json::array();
  ProgressLine progress(context);
  for (std::size_t c = 0; c < cases.size(); ++c) {
    check(progress.show({"matching", c, cases.size()}), ErrorCode::cancelled, "stopped");
    for (const MatchScore& score : compareMethods(cases[c], context.options().seed)) {
      std::vector<std::string> row{score.name, nameOf(score)};
      Json json{{"case", score.name}, {"method", nameOf(score)}};
      for (const Figure& figure : kFigures) {
        const double value = figure.value(score);
        row.push_back(numberText(value, figure.decimals));
        json[figure.name] = std::isfinite(value) ? Json(value) : Json(nullptr);
      }
      table.row(std::move(row));
      rows.push_back(std::move(json));
      if (bench.pictures.empty()) continue;
      std::string file = score.name + "-" + nameOf(score);
      for (char& letter : file)
        if (!std::isalnum(static_cast<unsigned char>(letter))) letter = '-';
      writeImage(fs::path(bench.pictures) / (file + ".png"), score.picture);
    }
  }
  progress.show({"matching", cases.size(), cases.size()});
  context.print("{}", table.text());
  return {{"matchers", std::move(rows)}, {"cases", bench.cases}};
}

}  // namespace ibr::app
