// SPDX-License-Identifier: Apache-2.0
// Command-line options with checked values. A bad value throws CLI::ValidationError, exit code 1.
#pragma once

#include <CLI/CLI.hpp>
#include <concepts>
#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/parse.h"
#include "shared/cli/exit_code.h"

namespace ibr::app {

struct CommonOptions;

/// Declares the options of all programs and commands: --json, --device, --disable-feature, --seed, --threads, -q, -v.
void declareCommonOptions(CLI::App& app, CommonOptions& options);

std::int64_t parsedInt(const std::string& option, const std::string& text, std::int64_t low, std::int64_t high);
double parsedDouble(const std::string& option, const std::string& text, double low, double high);

/// Parses a program's command line, then calls `check`, which throws CLI::ParseError for options that contradict each
/// other. --help, --version and errors are printed; the program then has to end with the returned code.
std::optional<ExitCode> parsed(
    CLI::App& app, int argc, char** argv, const std::function<void()>& check = [] {});

CLI::Option* addInt(CLI::App& app, const std::string& name, int& value, int low, int high,
                    const std::string& description);
/// Declares a count; its description ends with the default.
template <std::unsigned_integral T>
CLI::Option* addCount(CLI::App& app, const std::string& name, T& value, T low, T high, const std::string& description) {
  return app
      .add_option_function<std::string>(
          name, [name, &value, low, high](const std::string& text) { value = T(parsedInt(name, text, low, high)); },
          description + " [" + std::to_string(value) + "]")
      ->type_name("N");
}
CLI::Option* addDouble(CLI::App& app, const std::string& name, double& value, double low, double high,
                       const std::string& description);

/// Parses a number of bytes, at least 1, with suffix K, M or G for 2^10, 2^20 or 2^30: 1500000, 800M, 1.5G.
std::uint64_t parsedBytes(const std::string& option, const std::string& text);
CLI::Option* addBytes(CLI::App& app, const std::string& name, std::uint64_t& value, const std::string& description);

/// True if the option was given; a default of an option whose callback is always called does not count.
bool isSet(const CLI::Option& option);

/// Returns the given options with their values, as typed; without defaults and without the options in
/// `leftOut`.
std::vector<std::string> givenArguments(const CLI::App& app, const std::set<std::string>& leftOut = {});

/// Size as WxH, such as 1280x720.
struct PictureSize {
  int width = 0, height = 0;  // 0: not given
};
CLI::Option* addSize(CLI::App& app, const std::string& name, PictureSize& size, const std::string& description);

/// Declares --path auto:N: the number of views of a path made from the photographs.
CLI::Option* addAutoPath(CLI::App& app, int& frames);

/// Declares --fov: degrees, 0 if not given.
CLI::Option* addFov(CLI::App& app, double& degrees);

/// Declares --graph: the image graph is drawn over the images.
void addGraph(CLI::App& app, bool& graph);

/// Puts the options that `declare` declares into their own group of the help. Returns these options.
std::vector<CLI::Option*> inGroup(CLI::App& app, const std::string& group, const std::function<void()>& declare);

/// Throws CLI::ValidationError with `why` for the first of the options that was given.
void refuseIfSet(const std::vector<CLI::Option*>& options, const std::string& why);

/// Declares an option that takes one of a few words.
template <class T>
CLI::Option* addChoice(CLI::App& app, const std::string& name, T& value, std::vector<std::pair<std::string, T>> choices,
                       const std::string& description) {
  std::string words;
  for (const auto& [word, unused] : choices) words += (words.empty() ? "" : "|") + word;
  return app
      .add_option_function<std::string>(
          name,
          [name, words, choices, &value](const std::string& text) {
            for (const auto& [word, meaning] : choices)
              if (word == text) {
                value = meaning;
                return;
              }
            throw CLI::ValidationError(name, "'" + text + "' is not one of " + words);
          },
          description)
      ->type_name(words);
}

}  // namespace ibr::app
