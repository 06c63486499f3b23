// SPDX-License-Identifier: Apache-2.0
// The program `ibr`: a table of commands.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <vector>

#include "batch/command.h"
#include "ibr/error.h"
#include "shared/cli/options.h"
#include "shared/cli/signals.h"

namespace ibr::app {
namespace {

constexpr std::array kCommands{
    &kBuildCommand,  &kRefineCommand, &kOptimiseCommand, &kSweepCommand,  &kInfoCommand,    &kValidateCommand,
    &kRenderCommand, &kEvalCommand,   &kAccuracyCommand, &kWalkCommand,   &kCompareCommand, &kBenchCommand,
    &kSynthCommand,  &kSplitCommand,  &kHtmCommand,      &kDeviceCommand, &kDoctorCommand,  &kTradeoffCommand,
};

// Examples come first: most readers want one of them.
std::string helpText(const Command& command) {
  std::string text = "Examples:\n  ";
  for (const char c : std::string_view(command.examples)) text += c == '\n' ? std::string("\n  ") : std::string(1, c);
  text += fmt::format("\n\n{}.", command.summary);
  if (*command.details) text += fmt::format("\n\n{}", command.details);
  text += '\n';
  return text;
}

struct Declared {
  const Command* command;
  std::string words;  // as they are typed after "ibr"
  CLI::App* app;
  std::function<ExitCode(const Context&)> action;  // of a group: none

  std::string before() const {  // what is typed before its name
    return ("ibr " + words).substr(0, words.size() + 3 - std::string_view(command->name).size());
  }
};

// A group comes after its commands: the first that was parsed is what was meant.
void declare(CLI::App& parent, const std::string& before, const Command& command, CommonOptions& common,
             std::vector<Declared>& all) {
  CLI::App* sub = parent.add_subcommand(command.name, command.summary);
  sub->set_version_flag("--version", "ibr " IBR_VERSION);
  Declared declared{&command, before + command.name, sub, {}};
  for (const Command* further : command.commands) declare(*sub, declared.words + ' ', *further, common, all);
  if (command.commands.empty()) {
    declared.action = command.declare(*sub);
    declareCommonOptions(*sub, common);
  } else {
    sub->require_subcommand(1);
  }
  all.push_back(std::move(declared));
}

ExitCode run(int argc, char** argv) {
  CLI::App app(
      "Examples:\n"
      "  ibr build photographs -o scene\n"
      "  ibr render scene --path auto:90 -o pictures\n"
      "  ibr eval scene --truth held-out\n\n"
      "ibr makes new views from photographs whose poses are known.\n",
      "ibr");
  app.set_version_flag("--version", "ibr " IBR_VERSION);
  app.require_subcommand(1);
  CommonOptions common;
  std::vector<Declared> all;
  for (const Command* command : kCommands) declare(app, "", *command, common, all);
  const auto chosen = [&]() -> const Declared* {
    const auto found = std::ranges::find_if(all, [](const Declared& d) { return d.app->parsed(); });
    return found == all.end() ? nullptr : &*found;
  };

  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    const Declared* sub = chosen();
    if (sub) sub->app->description(helpText(*sub->command));
    std::fputs((sub ? sub->app->help(sub->before()) : app.help()).c_str(), stdout);
    flushResults();
    return kExitOk;
  } catch (const CLI::CallForVersion& e) {
    std::fputs((std::string(e.what()) + '\n').c_str(), stdout);
    flushResults();
    return kExitOk;
  } catch (const CLI::ParseError& e) {
    const Declared* sub = chosen();
    const bool unknown = !sub && argc > 1 && argv[1][0] != '-';
    return complain("ibr",
                    fmt::format("{}\nibr: ibr {}--help shows what there is",
                                unknown ? fmt::format("'{}' is no command", argv[1]) : std::string(e.what()),
                                sub ? sub->words + ' ' : std::string()),
                    kExitCommandLine);
  }

  const Context context(common);
  watchForInterrupt();
  try {
    const ExitCode code = chosen()->action(context);
    flushResults();
    return code;
  } catch (const Error& e) {
    if (e.code() != ErrorCode::cancelled) throw;
    context.say(LogLevel::warning, "stopped. {}", chosen()->command->afterInterrupt);
    return kExitInterrupted;
  }
}

}  // namespace
}  // namespace ibr::app

int main(int argc, char** argv) {
  return ibr::app::guarded("ibr", [&] { return ibr::app::run(argc, argv); });
}
