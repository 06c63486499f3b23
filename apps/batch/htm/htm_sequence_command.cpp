// SPDX-License-Identifier: Apache-2.0
// [H] §4: 3D video, a harmonised model a frame.
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

// Models replace what has their name: that must not be the frames.
void checkApart(const fs::path& frames, const fs::path& output) {
  const fs::path inner = fs::weakly_canonical(output), outer = fs::weakly_canonical(frames);
  const auto [end, unused] = std::ranges::mismatch(outer, inner);
  check(end != outer.end(), ErrorCode::invalidInput, "{}: lies in the folder of the frames, {}", output.string(),
        frames.string());
}

void printTable(const std::vector<HtmFrameInput>& frames, const std::vector<HtmFrameModel>& models,
                const Context& context) {
  Table table;
  table.row(
      {"frame", "faces", "D_f as it is", "D_f harmonised", "cameras off by px", "adjusted", "complements", "seconds"});
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
               models[f].kept ? "kept" : fmt::format("{:.1f}", models[f].seconds)});
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
      if (auto kept = keptHtmFrame(frame, build, folder)) {
        models.push_back(std::move(*kept));
        continue;
      }
      fs::remove(folder / kHtmSequenceFileName);  // until all frames are of one kind again
      models.push_back(buildHtmFrame(
          frame, build, folder, [&](const Progress&) { return show(); }, context.log()));
      context.say(LogLevel::info, "{}: {:.1f} s", frame.name, models.back().seconds);
    }
    progress.show({"harmonising frames", frames.size(), frames.size()});
  }
  HtmSequenceIndex index{options.fps, {}};
  for (const HtmFrameInput& frame : frames) index.frames.emplace_back(frame.name);
  saveHtmSequence(index, folder);

  printTable(frames, models, context);
  context.print("{}: {} frames, {:g} a second\n", options.output, frames.size(), options.fps);
  Json json{{"sequence", options.output}, {"fps", options.fps}, {"frames", Json::array()}};
  for (std::size_t f = 0; f < frames.size(); ++f) {
    Json line{{"frame", frames[f].name},
              {"kept", models[f].kept},
              {"seconds", models[f].kept ? Json() : Json(models[f].seconds)}};
    line.update(models[f].report);
    json["frames"].push_back(std::move(line));
  }
  context.report(json.dump(2, ' ', false, Json::error_handler_t::replace));
  return kExitOk;
}

}  // namespace

const Command kHtmSequenceCommand{
    .name = "sequence",
    .summary = "Makes 3D video: a harmonised model of each frame",
    .examples =
        "ibr htm sequence frames -o sequence\n"
        "ibr htm sequence frames -o sequence --fps 30 --faces 3000 --max-size 1024",
    .details =
        "FRAMES holds a folder a frame, in the order of their names, each with what `ibr htm build` takes: mesh.ply "
        "(or\n"
        ".obj, .gltf, .glb), a COLMAP model in sparse/, images/ and perhaps masks/. Meshes and cameras may be "
        "different\n"
        "ones in each. SEQUENCE gets a model folder of the same name for each, and sequence.json.\n"
        "Models that are there, made by this program of the same files with the same options, are kept: after new\n"
        "frames, changed ones or a stop, the same command makes what is missing.\n"
        "D_f is how differently photographs colour a face, in levels of 255.",
    .afterInterrupt = "The frames that are there are whole; the same command goes on with the others.",
    .declare = [](CLI::App& app) -> std::function<ExitCode(const Context&)> {
      const auto options = std::make_shared<Options>();
      app.add_option("FRAMES", options->frames, "Folder of a folder a frame")->required();
      app.add_option("-o,--output", options->output, "Sequence's folder; made where it is missing")
          ->required()
          ->type_name("SEQUENCE");
      addDouble(app, "--fps", options->fps, 0.001, 1000, "Frames a second");
      declareHtmBuildOptions(app, options->choices);
      return [options](const Context& context) { return buildSequence(*options, context); };
    }};

}  // namespace ibr::app
