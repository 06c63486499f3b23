// SPDX-License-Identifier: Apache-2.0
#include "ibr/lab/accuracy.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/check.h"
#include "base/file.h"
#include "batch/command.h"
#include "batch/files/poses.h"
#include "batch/files/truth.h"
#include "ibr/scene.h"
#include "io/image_file.h"
#include "lab/lab_commands.h"
#include "shared/cli/options.h"
#include "shared/cli/progress.h"
#include "shared/report/statistics.h"
#include "shared/report/table.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string scene, truth;
  double unit = 0.01;
  bool cells = false;
  std::string exact;
  ExactMatchOptions matches;
};

std::vector<ExactDepthView> depthViews(const Options& options, const Context& context) {
  const Truth truth(options.truth, {}, context.log());
  std::vector<ExactDepthView> views;
  for (const View& view : truth.views())
    views.push_back({view.camera, truthDepth(fs::path(options.truth) / "depth", view.name, options.unit)});
  return views;
}

double shareWithin(const std::vector<double>& values, double limit) {
  return double(std::ranges::count_if(values, [&](double v) { return v <= limit; })) / double(values.size());
}

// Figure with its name, for people and in JSON, and its value: NaN if nothing was counted.
struct Figure {
  const char* name;
  const char* heading;
  int decimals;
  double (*value)(const MatchAccuracy&);
};
constexpr Figure kFigures[] = {
    {"vertices", "vertices", 0, [](const MatchAccuracy& a) { return double(a.vertexErrorsPx.size()); }},
    {"medianPx", "median px", 3, [](const MatchAccuracy& a) { return quantile(a.vertexErrorsPx, 0.5); }},
    {"within1Px", "< 1 px", 4, [](const MatchAccuracy& a) { return shareWithin(a.vertexErrorsPx, 1.0); }},
    {"beyond3Px", "> 3 px", 4, [](const MatchAccuracy& a) { return 1.0 - shareWithin(a.vertexErrorsPx, 3.0); }},
    {"completeness", "completeness", 3, [](const MatchAccuracy& a) { return a.coVisibleTier0 / a.coVisible; }},
    {"precision", "precision", 3, [](const MatchAccuracy& a) { return a.correctTier0 / a.tier0; }},
    {"recall", "recall", 3, [](const MatchAccuracy& a) { return a.correctTier0 / a.correct; }},
    {"within1Sigma", "< 1 sigma", 3, [](const MatchAccuracy& a) { return shareWithin(a.deviation, 1.0); }},
    {"within2Sigma", "< 2 sigma", 3, [](const MatchAccuracy& a) { return shareWithin(a.deviation, 2.0); }},
    {"folded", "folded", 0, [](const MatchAccuracy& a) { return double(a.folded); }}};

void addRow(Table& table, const std::string& name, const MatchAccuracy& accuracy) {
  std::vector<std::string> row{name};
  for (const Figure& figure : kFigures) row.push_back(numberText(figure.value(accuracy), figure.decimals));
  table.row(std::move(row));
}

Json figuresJson(const MatchAccuracy& accuracy) {
  Json json = Json::object();
  for (const Figure& figure : kFigures) json[figure.name] = figure.value(accuracy);
  return json;
}

void writeExact(Scene scene, std::span<const ExactDepthView> truth, const Options& options, const Context& context) {
  std::error_code ignored;
  check(!fs::equivalent(scene.folder, options.exact, ignored), ErrorCode::invalidInput,
        "{}: the scene would overwrite itself; choose another folder for --exact", options.exact);
  ExactMatchOptions matches = options.matches;
  matches.seed = context.options().seed;
  std::size_t moved = 0;
  {
    ProgressLine progress(context);
    moved = setExactMatches(scene, truth, matches, context.options().threads, progress.callback());
  }
  saveSceneWithLinks(scene, options.exact);
  context.print("{}: {} points were moved to their exact matches\n", options.exact, moved);
}

ExitCode measure(const Options& options, const Context& context) {
  const Scene scene = loadScene(options.scene);
  const std::vector<ExactDepthView> truth = depthViews(options, context);
  if (!options.exact.empty()) writeExact(scene, truth, options, context);
  std::vector<MatchAccuracy> cells;
  {
    ProgressLine progress(context);
    cells = matchAccuracy(scene, truth, context.options().threads, progress.callback());
  }
  Table table;
  std::vector<std::string> heading{"cells"};
  for (const Figure& figure : kFigures) heading.push_back(figure.heading);
  table.row(std::move(heading));
  Json cellsJson = Json::array(), kindsJson = Json::object();
  for (std::size_t c = 0; c < cells.size(); ++c) {
    std::string names;
    Json members = Json::array();
    for (const std::uint32_t n : scene.cells[c].members) {
      names += (names.empty() ? "" : " ") + scene.nodes[n].name;
      members.push_back(scene.nodes[n].name);
    }
    if (options.cells) addRow(table, names, cells[c]);
    Json json = figuresJson(cells[c]);
    json["members"] = std::move(members);
    cellsJson.push_back(std::move(json));
  }
  for (const auto& [name, least, most] :
       {std::tuple("lines", 2, 2), {"triangles", 3, 3}, {"tetrahedra", 4, 4}, {"all", 2, 4}}) {
    MatchAccuracy sum;
    int count = 0;
    for (std::size_t c = 0; c < cells.size(); ++c)
      if (const int d = int(scene.cells[c].members.size()); d >= least && d <= most) sum += cells[c], ++count;
    if (count == 0) continue;
    addRow(table, fmt::format("{} {}", count, name), sum);
    kindsJson[name] = figuresJson(sum);
  }
  context.print("{}", table.text());
  context.report(Json{{"cells", cellsJson}, {"kinds", kindsJson}, {"scene", options.scene}, {"truth", options.truth}});
  return kExitOk;
}

}  // namespace

const Command kAccuracyCommand{
    .name = "accuracy",
    .summary = "Compares matches and tiers of a scene's cells with exact depth",
    .examples =
        "ibr-lab accuracy scene --truth held-out\n"
        "ibr-lab accuracy scene --truth held-out --depth-unit 0.001 --cells --json accuracy.json\n"
        "ibr-lab accuracy scene --truth held-out --exact perfect\n"
        "ibr-lab accuracy scene --truth held-out --exact disturbed --noise 2",
    .details =
        "DIR has images/, a COLMAP model in sparse/, and in depth/ a 16-bit PNG for each view.\n"
        "Depth is along the viewing axis at pixel centres; 0 is the sky. Errors are those of\n"
        "tier-0 vertices in the worst member, in px of the stored photographs. Kept is the share\n"
        "of pixels seen by all members that is under tier 0. A triangle is right if 80 % of its\n"
        "area is within 1.5 px and seen by all members. Precision is the share of tier 0 that is\n"
        "right. Recall is the share of right triangles that are in tier 0. Sigma is the\n"
        "uncertainty of the inverse distance that a vertex stores.\n"
        "--exact writes the scene with exact matches, where matches are within 4 px. Images of\n"
        "this scene show the loss through wrong matches. With --noise, matches of the written\n"
        "scene are inaccurate, as input for an optimiser.",
    .afterInterrupt = "no report was written; run the same command again",
    .declare = [](CLI::App& app) -> std::function<ExitCode(const Context&)> {
      const auto options = std::make_shared<Options>();
      addOption(app, "SCENE", options->scene, "Scene folder").required();
      addOption(app, "--truth", options->truth, "Folder of views with exact depth").required().type("DIR");
      addDouble(app, "--depth-unit", options->unit, 1e-9, 1e9, "World units per step of a depth image");
      addFlag(app, "--cells", options->cells, "Also print a line for each cell");
      const Option exact = addOption(app, "--exact", options->exact,
                                     "Folder for a copy of the scene with exact matches; created if "
                                     "missing")
                               .type("DIR");
      addDouble(app, "--noise", options->matches.noisePx, 0, 64,
                "Maximum error added to exact matches, px in each coordinate, uniformly distributed")
          .needs(exact);
      return [options](const Context& context) { return measure(*options, context); };
    }};

}  // namespace ibr::app
