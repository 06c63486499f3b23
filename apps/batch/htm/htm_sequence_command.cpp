// SPDX-License-Identifier: Apache-2.0
// `ibr htm sequence`: 3D video with a harmonised model for each frame ([H] §4).
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/check.h"
#include "base/file.h"
#include "batch/htm/htm_commands.h"
#include "batch/htm/htm_frames.h"
#include "batch/htm/htm_options.h"
#include "ibr/error.h"
#include "ibr/htm_sequence.h"
#include "shared/cli/options.h"
#include "shared/cli/progress.h"
#include "shared/report/table.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  HtmBuildChoices choices;
  std::string frames, output;
  double fps = HtmSequenceIndex().fps;
};

// Models replace folders of the same name, so the output must not lie in the frames' folder.
void checkApart(const fs::path& frames, const fs::path& output) {
  const fs::path inner = fs::weakly_canonical(output), outer = fs::weakly_canonical(frames);
  const auto [end, unused] = std::ranges::mismatch(outer, inner);
  check(end != outer.end(), ErrorCode::invalidInput,
        "{}: lies in the folder of the frames, {}; choose another output folder", output.string(), frames.string());
}

void printTable(const std::vector<HtmFrameInput>& frames, const std::vector<HtmFrameModel>& models,
                const Context& context) {
  Table table;
  table.row(
      {"frame", "faces", "D_f unharmonised", "D_f harmonised", "offset px", "adjusted px", "complements", "seconds"});
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const Json& report = models[f].report;
    const Json& round = report.at("rounds").back();
    const Json& adjustments = report.at("adjustments");
    const auto px = [&](const Json& of, const char* name) { return numberText(of.at(name).get<double>(), 2); };
    table.row({frames[f].name, fmt::format("{}", round.at("faces").get<std::size_t>()),
               numberText(round.at("before").get<double>(), 3), numberText(round.at("after").get<double>(), 3),
               adjustments.empty() ? "–" : px(adjustments.front(), "beforePx"),
               adjustments.empty() ? "–" : px(adjustments.back(), "afterPx"),
               bytesText(report.at("complementBytes").get<double>()),
               models[f].kept ? "cached" : fmt::format("{:.1f}", models[f].seconds)});
  }
  context.print("{}", table.text());
}

ExitCode buildSequence(const Options& options, const Context& context) {
  const fs::path folder = options.output;
  const std::vector<HtmFrameInput> frames = findHtmFrames(options.frames);
  checkApart(options.frames, folder);
  HtmBuildOptions build = options.choices.build;
  const std::unique_ptr<Device> device = prepare(build, options.choices, context);
  std::vector<HtmFrameModel> models;
  {
    ProgressLine progress(context);
    for (const HtmFrameInput& frame : frames) {
      const auto show = [&] { return progress.show({"harmonising frames", models.size(), frames.size()}); };
      check(show(), ErrorCode::cancelled, "stopped");
      if (auto kept = cachedHtmFrame(frame, build, folder)) {
        models.push_back(std::move(*kept));
        continue;
      }
      fs::remove(folder / kHtmSequenceFileName);  // the index is valid only for frames of the same options
      models.push_back(buildHtmFrame(
          frame, build, folder, [&](const Progress&) { return show(); }, context.log()));
      context.logMessage(LogLevel::info, "{}: {:.1f} s", frame.name, models.back().seconds);
    }
    progress.show({"harmonising frames", frames.size(), frames.size()});
  }
  HtmSequenceIndex index{options.fps, {}};
  for (const HtmFrameInput& frame : frames) index.frames.emplace_back(frame.name);
  saveHtmSequence(index, folder);

  printTable(frames, models, context);
  context.print("{}: {} frames, {:g} per second\n", options.output, frames.size(), options.fps);
  Json json{{"sequence", options.output}, {"fps", options.fps}, {"frames", Json::array()}};
  for (std::size_t f = 0; f < frames.size(); ++f) {
    Json line{{"frame", frames[f].name},
              {"cached", models[f].kept},
              {"seconds", models[f].kept ? Json() : Json(models[f].seconds)}};
    line.update(models[f].report);
    json["frames"].push_back(std::move(line));
  }
  context.report(json);
  return kExitOk;
}

}  // namespace

const Command kHtmSequenceCommand{
    .name = "sequence",
    .summary = "Builds 3D video: a harmonised model for each frame",
    .examples =
        "ibr htm sequence frames -o sequence\n"
        "ibr htm sequence frames -o sequence --fps 30 --faces 3000 --max-size 1024",
    .details =
        "FRAMES holds one folder per frame, in the order of their names. Each folder has the\n"
        "input of `ibr htm build`: mesh.ply (or .obj, .gltf, .glb), a COLMAP model in sparse/,\n"
        "images/ and optionally masks/. Meshes and cameras may differ from frame to frame.\n"
        "SEQUENCE gets a model folder of the same name for each frame, and sequence.json.\n"
        "Models that this program built from the same files with the same options are cached.\n"
        "After new frames, changed frames or a stop, the same command builds the missing models.\n"
        "D_f is the colour difference of the photographs on a face, in 8-bit levels.",
    .afterInterrupt = "finished frames are cached; run the same command again to resume",
    .mainOptions = "output fps faces adjust rounds json",
    .declare = [](CLI::App& app) -> std::function<ExitCode(const Context&)> {
      const auto options = std::make_shared<Options>();
      addOption(app, "FRAMES", options->frames, "Folder with one folder per frame").required();
      addOption(app, "-o,--output", options->output, "Sequence folder; created if missing").required().type("SEQUENCE");
      addDouble(app, "--fps", options->fps, 0.001, 1000, "Frames per second");
      declareHtmBuildOptions(app, options->choices);
      return [options](const Context& context) { return buildSequence(*options, context); };
    }};

}  // namespace ibr::app
