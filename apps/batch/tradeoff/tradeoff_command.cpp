// SPDX-License-Identifier: Apache-2.0
// `ibr tradeoff`: cost and accuracy of each render setting, and checks of the presets
// (libibr/docs/tradeoff.md).
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "batch/command.h"
#include "batch/command_text.h"
#include "batch/tradeoff/tradeoff_inputs.h"
#include "batch/tradeoff/tradeoff_run.h"
#include "batch/tradeoff/tradeoff_settings.h"
#include "shared/cli/options.h"

namespace ibr::app {
namespace {

using SharedOptions = std::shared_ptr<TradeoffOptions>;

// Options of the scene and of the views.
void declareViews(CLI::App& app, const SharedOptions& options) {
  addOption(app, "SCENE", options->scene, "Scene folder").required();
  addOption(app, "-o,--output", options->output, "Folder for the measurements; created if missing")
      .required()
      .type("DIR");
  const Option truth = addOption(app, "--truth", options->truth, "Held-out photographs with their poses").type("DIR");
  addOption(app, "--only", options->only, "Compare only these views of the truth, by name")
      .needs(truth)
      .type("NAME...");
  addInt(app, "--shrink", options->shrink, 1, 64, "Factor by which the truth's images are reduced: means of N × N px")
      .needs(truth);
  addOption(app, "--poses,--views", options->poses,
            "File or folder of further views: poses in any format of ibr build --model, or camera path")
      .type("FILE");
  addAutoPath(app, options->autoViews);
  addSize(app, "--size", options->size,
          "Size of the images of --poses and --path [that of the poses; of the "
          "photographs]");
}

// Options of the settings and of their measurement.
void declareMeasurement(CLI::App& app, const SharedOptions& options) {
  addOption(app, "--knobs", options->knobs,
            "Vary only these settings: " + fmt::format("{}", fmt::join(tradeoffKnobNames(), " ")))
      .type("NAME...");
  addFlagCallback(
      app, "--no-grid", [options] { options->grid = false; }, "Measure no combinations of settings");
  addOption(app, "--build", options->builds,
            "Also measure further builds of the same photographs, drawn with "
            "default settings")
      .type("NAME=SCENE...");
  addOption(app, "--sweep", options->sweep,
            "Also show the results of ibr-lab sweep for this scene, from its "
            "sweep.json")
      .type("FILE");
  addInt(app, "--repeat", options->repeat, 1, 10'000, "Rounds of time measurements");
  addInt(app, "--walk", options->walk, 0, 1'000'000,
         "Number of frames of a walk through the scene; frames around changes of the main cell are drawn; 0: no "
         "walk");
  addFlag(app, "--check", options->check,
          "Exit with code 6 if a preset does not meet its guarantees for counts and images; times are not "
          "checked");
  addFlag(app, "--list", options->list, "Only list the settings");
}

std::function<ExitCode(const Context&)> declareTradeoff(CLI::App& app) {
  const auto options = std::make_shared<TradeoffOptions>();
  declareViews(app, options);
  declareMeasurement(app, options);
  afterParsing(app, [options, &app] {
    if (options->knobs == std::vector<std::string>{"default"}) options->knobs.clear();
    for (const std::string& knob : options->knobs) {
      const std::vector<std::string> names = tradeoffKnobNames();
      if (std::ranges::find(names, knob) == names.end())
        refuseOption("--knobs",
                     "unknown setting '" + knob + "'; choose from " + fmt::format("{}", fmt::join(names, ", ")));
    }
    options->command = commandText("ibr tradeoff", givenArguments(app));
  });
  return [options](const Context& context) { return runTradeoff(*options, context); };
}

}  // namespace

const Command kTradeoffCommand{
    .name = "tradeoff",
    .summary = "Measures time, memory and accuracy of each render setting",
    .examples =
        "ibr tradeoff scene -o report\n"
        "ibr tradeoff scene --truth held-out --shrink 2 -o report\n"
        "ibr tradeoff scene --path auto:4 --size 640x360 --knobs cells renderScale --repeat 5 -o report\n"
        "ibr tradeoff scene --truth held-out --build coarse=scene8 fine=scene2 -o report\n"
        "ibr tradeoff scene --list -o report",
    .details =
        "One setting (knob) at a time is varied from the default (--preset balanced). Then the\n"
        "four presets and combinations of the most important settings are measured. Images are\n"
        "rendered once; times are measured in rounds over all settings. Three accuracies are\n"
        "reported separately: against held-out photographs (--truth), against --preset reference,\n"
        "and for the device against a reference implementation in double precision. Views are\n"
        "those of the truth, of --poses and of --path, together. Times are those of the device\n"
        "and of planning, without the copy to the host. Run nothing else on the machine during\n"
        "the measurement.\n"
        "The folder gets tradeoff.json, tradeoff.csv, figures, and report.html, which contains\n"
        "all of them.",
    .afterInterrupt = "finished measurements are cached; run the same command again to resume",
    .mainOptions = "output truth only shrink path size knobs no-grid check json",
    .declare = declareTradeoff};

}  // namespace ibr::app
