// SPDX-License-Identifier: Apache-2.0
#include "batch/build/build_steps_command.h"

#include <nlohmann/json.hpp>
#include <set>

#include "base/usage.h"
#include "shared/cli/options.h"
#include "shared/cli/progress.h"

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

Json json(const BuildStep& step, const StepChoices& choices) {
  Json arguments = Json::array();
  arguments.push_back("build");
  for (const std::string& word : choices.arguments) arguments.push_back(word);
  arguments.push_back("--photographs-per-step");
  arguments.push_back(std::to_string(choices.photographs));
  arguments.push_back("--step");
  arguments.push_back(step.name);
  Json json{{"name", step.name}, {"arguments", arguments}, {"inputs", Json::array()}};
  for (const std::filesystem::path& input : step.inputs) json["inputs"].push_back(input.string());
  json["output"] = step.output.string();
  json["seconds"] = step.seconds;
  json["memory"] = step.memory;
  return json;
}

}  // namespace

nlohmann::ordered_json stepUsage(const std::string& step) {
  return {{"step", step},
          {"processorSeconds", cpuSeconds()},
          {"memory", peakMemory()},
          {"readBytes", readBytes()},
          {"writtenBytes", writtenBytes()}};
}

void declareStepOptions(CLI::App& app, StepChoices& choices) {
  addFlag(app, "--steps", choices.list,
          "List the steps of the build as JSON, for many processes or machines on one folder; build nothing");
  addOption(app, "--step", choices.step, "Run only this step of the list").type("NAME");
  addInt(app, "--photographs-per-step", choices.photographs, 1, 100000,
         "Photographs that a step handles; the same for all steps of a build");
}

void noteArguments(const CLI::App& app, StepChoices& choices) {
  static const std::set<std::string> kLeftOut{
      "--steps", "--step", "--photographs-per-step", "--json", "--threads", "--memory", "--quiet", "--verbose"};
  choices.arguments = givenArguments(app, kLeftOut);
}

ExitCode listSteps(const StepChoices& choices, const BuildOptions& options, const Context& context) {
  Json report{{"version", 1}, {"scene", options.output.string()}, {"steps", Json::array()}};
  for (const BuildStep& step : buildSteps(options, std::size_t(choices.photographs), context.log()))
    report["steps"].push_back(json(step, choices));
  CommonOptions output = context.options();
  if (output.json.empty()) output.json.push_back('-');
  Context(output).report(report);
  return kExitOk;
}

ExitCode runStep(const StepChoices& choices, const BuildOptions& options, const Context& context) {
  ProgressLine progress(context);
  runBuildStep(options, std::size_t(choices.photographs), choices.step, progress.callback(), context.log());
  context.report(stepUsage(choices.step));
  return kExitOk;
}

}  // namespace ibr::app
