// SPDX-License-Identifier: Apache-2.0
// Options whose values are checked when they are read: a bad one is a CLI::ValidationError, exit code 1.
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

/// --json, --device, --disable-feature, --seed, --threads, -q, -v, which all programs and commands have.
void declareCommonOptions(CLI::App& app, CommonOptions& options);

std::int64_t parsedInt(const std::string& option, const std::string& text, std::int64_t low, std::int64_t high);
double parsedDouble(const std::string& option, const std::string& text, double low, double high);

/// Parses the command line of a program and then calls `check`, which throws CLI::ParseError where options do not go
/// together. What is asked for instead (--help, --version) or is wrong is told; then the program ends with this code.
std::optional<ExitCode> parsed(CLI::App& app, int argc, char** argv, const std::function<void()>& check);

CLI::Option* addInt(CLI::App& app, const std::string& name, int& value, int low, int high,
                    const std::string& description);
/// The description's end tells the default.
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

/// A number of bytes, at least 1, with K, M or G for 2^10, 2^20 or 2^30 of them: 1500000, 800M, 1.5G.
std::uint64_t parsedBytes(const std::string& option, const std::string& text);
CLI::Option* addBytes(CLI::App& app, const std::string& name, std::uint64_t& value, const std::string& description);

/// Whether it was, other than as the default of an option whose callback is always called.
bool wasGiven(const CLI::Option& option);

/// Options that were given, each with its values, as they would be typed; without defaults and those that `leftOut`
/// names.
std::vector<std::string> givenWords(const CLI::App& app, const std::set<std::string>& leftOut = {});

/// WxH, as in 1280x720.
struct PictureSize {
  int width = 0, height = 0;  // 0: not given
};
CLI::Option* addSize(CLI::App& app, const std::string& name, PictureSize& size, const std::string& description);

/// --path auto:N: how many views of a path that is made from the photographs.
CLI::Option* addAutoPath(CLI::App& app, int& frames);

/// --fov: degrees, 0 where it is not given.
CLI::Option* addFov(CLI::App& app, double& degrees);

/// --graph: the image graph is drawn over the pictures.
void addGraph(CLI::App& app, bool& graph);

/// What `declare` declares becomes a group of its own in the help; these options.
std::vector<CLI::Option*> inGroup(CLI::App& app, const std::string& group, const std::function<void()>& declare);

/// Throws CLI::ValidationError of the first of them that was given, with `why`.
void refuseGiven(const std::vector<CLI::Option*>& options, const std::string& why);

/// One of a few words.
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
            throw CLI::ValidationError(name, "'" + text + "' is none of " + words);
          },
          description)
      ->type_name(words);
}

}  // namespace ibr::app
