// SPDX-License-Identifier: Apache-2.0
#include "batch/program.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "ibr/error.h"
#include "ibr/version.h"
#include "shared/cli/describe.h"
#include "shared/cli/near_name.h"
#include "shared/cli/options.h"
#include "shared/cli/signals.h"

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

// Starts with the examples, which most readers look for.
std::string helpText(const Command& command, bool all) {
  std::string text = "Examples:\n  ";
  for (const char c : std::string_view(command.examples)) text += c == '\n' ? std::string("\n  ") : std::string(1, c);
  text += fmt::format("\n\n{}.", command.summary);
  if (all && *command.details) text += fmt::format("\n\n{}", command.details);
  text += '\n';
  return text;
}

bool isAmong(std::string_view words, const std::string& word) {
  return (' ' + std::string(words) + ' ').find(' ' + word + ' ') != std::string::npos;
}

// Removes all but the main options from the help.
void hideOtherOptions(const Command& command, CLI::App& app) {
  if (!*command.mainOptions) return;
  std::size_t hidden = 0;
  for (CLI::Option* option : app.get_options()) {
    const bool positional = option->get_lnames().empty() && option->get_snames().empty();
    const auto isMain = [&](const std::string& name) { return isAmong(command.mainOptions, name); };
    const bool wanted = positional || std::ranges::any_of(option->get_lnames(), isMain) || option == app.get_help_ptr();
    if (wanted) {
      option->group("Options");
    } else {
      option->group("");
      ++hidden;
    }
  }
  app.footer(fmt::format("--help-all shows details and {} more options.", hidden));
}

struct Declared {
  const Command* command;
  std::string words;  // as typed after the program's name
  CLI::App* app;
  std::function<ExitCode(const Context&)> action;  // empty for a group

  // Returns the words before the command's name.
  std::string before(const char* program) const {
    const std::string line = std::string(program) + ' ' + words;
    return line.substr(0, line.size() - 1 - std::string_view(command->name).size());
  }
};

// Appends a group after its commands, so that the first parsed entry is the command itself.
void declare(CLI::App& parent, const std::string& version, const std::string& before, const Command& command,
             CommonOptions& common, std::vector<Declared>& all) {
  CLI::App* sub = parent.add_subcommand(command.name, command.summary);
  sub->set_version_flag("--version", version);
  sub->set_help_all_flag("--help-all", "Print all options and exit");
  Declared declared{&command, before + command.name, sub, {}};
  for (const Command* further : command.commands) declare(*sub, version, declared.words + ' ', *further, common, all);
  if (command.commands.empty()) {
    declared.action = command.declare(*sub);
    declareCommonOptions(*sub, common);
  } else {
    sub->require_subcommand(1);
  }
  all.push_back(std::move(declared));
}

// Groups are left out: their commands have the group's name in "command".
Json describe(const Program& program, const std::vector<Declared>& all) {
  Json commands = Json::array();
  for (const auto& [command, words, app, action] : all) {
    if (!action) continue;
    commands.push_back({{"command", words},
                        {"summary", command->summary},
                        {"examples", command->examples},
                        {"details", command->details},
                        {"afterInterrupt", command->afterInterrupt},
                        {"mainOptions", command->mainOptions},
                        {"options", describeOptions(*app)}});
  }
  return {{"program", program.name},
          {"version", std::string(ibr::version())},
          {"help", program.help},
          {"commands", commands},
          {"exitCodes", describeExitCodes()}};
}

// Fault of a command line that `what` describes. `command`: the command or group that was recognised; may be null.
std::string commandLineFault(const Program& program, std::span<const char* const> arguments, const Declared* command,
                             const std::string& what) {
  const std::string line = command ? fmt::format("{} {}", program.name, command->words) : program.name;
  const auto text = [&](const std::string& fault, const char* listed) {
    return fmt::format("{}\n{}: {} --help lists the {}", fault, program.name, line, listed);
  };
  if (command && command->action) return text(misspeltOption(*command->app, arguments).value_or(what), "options");
  auto unknown = arguments.begin();  // the word after those that were recognised
  if (command) unknown = std::find(unknown, arguments.end(), std::string_view(command->command->name)) + 1;
  if (unknown == arguments.end() || **unknown == '-') return text(what, "commands");
  std::vector<std::string> names;
  for (const Command* each : command ? command->command->commands : program.commands) names.emplace_back(each->name);
  const auto near = nearName(*unknown, names);
  return text(fmt::format("'{}' is not a command{}", *unknown, near ? "; did you mean " + *near + "?" : ""),
              "commands");
}

ExitCode printHelp(const Program& program, const CLI::App& app, const Declared* command, bool all) {
  if (command) command->app->description(helpText(*command->command, all));
  std::fputs((command ? command->app->help(command->before(program.name)) : app.help()).c_str(), stdout);
  flushResults();
  return kExitOk;
}

ExitCode runCommands(const Program& program, int argc, char** argv) {
  const std::string name = program.name, version = name + " " + std::string(ibr::version());
  CLI::App app(program.help, name);
  app.set_version_flag("--version", version);
  app.require_subcommand(1);
  CommonOptions common;
  common.program = program.name;
  std::vector<Declared> all;
  for (const Command* command : program.commands) declare(app, version, "", *command, common, all);
  const auto chosen = [&]() -> const Declared* {
    const auto found = std::ranges::find_if(all, [](const Declared& d) { return d.app->parsed(); });
    return found == all.end() ? nullptr : &*found;
  };

  if (argc == 2 && argv[1] == kDescribe) {
    printDescription(describe(program, all));
    return kExitOk;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForAllHelp&) {
    return printHelp(program, app, chosen(), true);
  } catch (const CLI::CallForHelp&) {
    if (const Declared* sub = chosen()) hideOtherOptions(*sub->command, *sub->app);
    return printHelp(program, app, chosen(), false);
  } catch (const CLI::CallForVersion& e) {
    std::fputs((std::string(e.what()) + '\n').c_str(), stdout);
    flushResults();
    return kExitOk;
  } catch (const CLI::ParseError& e) {
    return printError(name, commandLineFault(program, {argv + 1, argv + argc}, chosen(), e.what()), kExitCommandLine);
  }

  const Context context(common);
  watchForInterrupt();
  try {
    const ExitCode code = chosen()->action(context);
    flushResults();
    return code;
  } catch (const Error& e) {
    if (e.code() != ErrorCode::cancelled) throw;
    const std::string_view hint = chosen()->command->afterInterrupt;
    context.logMessage(LogLevel::warning, "stopped{}{}", hint.empty() ? "" : ": ", hint);
    return kExitInterrupted;
  }
}

}  // namespace

int runProgram(const Program& program, int argc, char** argv) {
  return guarded(program.name, [&] { return runCommands(program, argc, argv); });
}

}  // namespace ibr::app
