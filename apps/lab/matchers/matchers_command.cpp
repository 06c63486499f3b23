// SPDX-License-Identifier: Apache-2.0
// Compares the matching methods in one table.
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/check.h"
#include "batch/command.h"
#include "ibr/lab/matchers.h"
#include "io/image_file.h"
#include "lab/lab_commands.h"
#include "shared/cli/options.h"
#include "shared/cli/progress.h"
#include "shared/report/table.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string cases;     // file for readMatchCases
  std::string data;      // folder that the file's paths are relative to; empty: the file's own folder
  std::string pictures;  // folder for the mean image of each method; empty: none
};

std::string nameOf(const MatchScore& score) {
  return std::string(matchMethodName(score.method)) +
         (score.filter == TriangleFilter::homogeneous ? ", homogeneous" : "");
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
                               {"completeness", "completeness", 3, [](const MatchScore& s) { return s.completeness; }},
                               {"precision", "precision", 3, [](const MatchScore& s) { return s.precision; }},
                               {"coverage", "coverage", 3, [](const MatchScore& s) { return s.coverage; }},
                               {"memberPsnr", "member dB", 1, [](const MatchScore& s) { return s.memberPsnr; }},
                               {"ecc", "ECC", 3, [](const MatchScore& s) { return s.ecc; }},
                               {"homogeneous", "homogeneous", 3, [](const MatchScore& s) { return s.homogeneous; }},
                               {"cpuSeconds", "CPU s", 1, [](const MatchScore& s) { return s.cpuSeconds; }}};

ExitCode compare(const Options& options, const Context& context) {
  const fs::path data = options.data.empty() ? fs::path(options.cases).parent_path() : fs::path(options.data);
  const std::vector<MatchCase> cases = readMatchCases(options.cases, data);
  if (!options.pictures.empty()) fs::create_directories(options.pictures);
  Table table;
  std::vector<std::string> heading{"case", "method"};
  for (const Figure& figure : kFigures) heading.push_back(figure.heading);
  table.row(std::move(heading));
  Json rows = Json::array();
  ProgressLine progress(context);
  for (std::size_t c = 0; c < cases.size(); ++c) {
    check(progress.show({"matching", c, cases.size()}), ErrorCode::cancelled, "stopped");
    for (const MatchScore& score : compareMatchMethods(cases[c], context.options().seed)) {
      std::vector<std::string> row{score.name, nameOf(score)};
      Json json{{"case", score.name}, {"method", nameOf(score)}};
      for (const Figure& figure : kFigures) {
        const double value = figure.value(score);
        row.push_back(numberText(value, figure.decimals));
        json[figure.name] = std::isfinite(value) ? Json(value) : Json(nullptr);
      }
      table.row(std::move(row));
      rows.push_back(std::move(json));
      if (options.pictures.empty()) continue;
      std::string file = score.name + "-" + nameOf(score);
      for (char& letter : file)
        if (!std::isalnum(static_cast<unsigned char>(letter))) letter = '-';
      writeImage(fs::path(options.pictures) / (file + ".png"), score.picture);
    }
  }
  progress.show({"matching", cases.size(), cases.size()});
  context.print("{}", table.text());
  context.report(Json{{"matchers", std::move(rows)}, {"cases", options.cases}});
  return kExitOk;
}

}  // namespace

const Command kMatchersCommand{
    .name = "matchers",
    .summary = "Compares the matching methods on pairs and cells of photographs",
    .examples = "ibr-lab matchers cases.json --data photographs --pictures compared",
    .details =
        "FILE lists {\"name\", \"images\"} under \"cases\", with \"model\", \"maxSize\", and\n"
        "\"disparity\", \"homography\" or \"depth\" and \"depthUnit\" if known. Errors are those\n"
        "of the vertices of blended triangles. \"member dB\" is the PSNR between members in these\n"
        "triangles, without differences of exposure.",
    .afterInterrupt = "no report was written; run the same command again",
    .declare = [](CLI::App& app) -> std::function<ExitCode(const Context&)> {
      const auto options = std::make_shared<Options>();
      addOption(app, "FILE", options->cases, "JSON file with the list of cases").required();
      addOption(app, "--data", options->data, "Base folder of paths in FILE [that of FILE]").type("DIR");
      addOption(app, "--pictures", options->pictures, "Folder for the mean image of each method").type("DIR");
      return [options](const Context& context) { return compare(*options, context); };
    }};

}  // namespace ibr::app
