// SPDX-License-Identifier: Apache-2.0
// Command-line options with checked values, without CLI11's expensive header. A bad value throws CLI::ValidationError,
// exit code 1.
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "shared/cli/cli_fwd.h"
#include "shared/cli/exit_code.h"

namespace ibr::app {

struct CommonOptions;

/// Refers to a declared option; copies refer to the same option. Calls that change the option return it, so that they
/// can be chained.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}

  Option required() const;
  /// Sets the word that stands for a value in the help, such as FILE.
  Option type(const std::string& word) const;
  /// Splits each value at `separator` into several values.
  Option delimiter(char separator) const;
  /// Sets the number of values.
  Option expected(int count) const;
  Option expected(int min, int max) const;
  /// Accepts only whole numbers from `low` to `high`; the help shows both.
  Option range(int low, int high) const;
  /// Accepts only these words; the help lists them.
  Option oneOf(const std::vector<std::string>& words) const;
  /// Calls `check` for each value before values are stored. `check` calls refuseOption for a bad value.
  Option check(const std::function<void(const std::string&)>& check) const;
  Option needs(Option other) const;
  Option excludes(Option other) const;
  /// Excludes an option that is already declared, by name.
  Option excludes(const std::string& other) const;
  /// Sets the heading of the help under which the option is listed; "": the help does not list the option.
  Option group(const std::string& heading) const;

  /// Returns the long name if there is one, such as "--output".
  std::string name() const;
  /// True if the option was given; a default of an option whose callback is always called does not count.
  bool isSet() const;

 private:
  CLI::Option* option_;
};

/// Throws CLI::ValidationError: "`name`: `message`".
[[noreturn]] void refuseOption(const std::string& name, const std::string& message);
/// Throws CLI::ValidationError with `message`, which names the options.
[[noreturn]] void refuseOptions(const std::string& message);
/// Throws CLI::RequiredError: "`name` is required".
[[noreturn]] void requireOption(const std::string& name);
/// Throws CLI::ValidationError with `why` for the first of the options that was given.
void refuseIfSet(const std::vector<Option>& options, const std::string& why);

/// Declare an option whose value is stored in `value`. A name without dashes declares a positional argument.
Option addOption(CLI::App& app, const std::string& name, std::string& value, const std::string& description);
Option addOption(CLI::App& app, const std::string& name, std::vector<std::string>& values,
                 const std::string& description);
Option addOption(CLI::App& app, const std::string& name, std::vector<int>& values, const std::string& description);
Option addOption(CLI::App& app, const std::string& name, std::filesystem::path& value, const std::string& description);
Option addOption(CLI::App& app, const std::string& name, std::size_t& value, const std::string& description);
/// Declare an option whose value `parse` checks and stores.
Option addParsed(CLI::App& app, const std::string& name, const std::function<void(const std::string&)>& parse,
                 const std::string& description);
Option addParsedList(CLI::App& app, const std::string& name,
                     const std::function<void(const std::vector<std::string>&)>& parse, const std::string& description);

Option addFlag(CLI::App& app, const std::string& name, bool& value, const std::string& description);
/// Declares a flag that may have a value, as in --name=value. `name` ends with the default in braces.
Option addFlag(CLI::App& app, const std::string& name, std::string& value, const std::string& description);
/// Declares a flag that calls `given`.
Option addFlagCallback(CLI::App& app, const std::string& name, const std::function<void()>& given,
                       const std::string& description);

void removeOption(CLI::App& app, const std::string& name);

/// Returns the options that `declare` declares, in the order of their declaration.
std::vector<Option> declaredBy(CLI::App& app, const std::function<void()>& declare);
/// Puts the options that `declare` declares into their own group of the help. Returns these options.
std::vector<Option> inGroup(CLI::App& app, const std::string& group, const std::function<void()>& declare);

/// Makes all arguments from the first one that is no option of the app available from remainingArguments.
void passArgumentsOn(CLI::App& app);
std::vector<std::string> remainingArguments(const CLI::App& app);

/// Calls `check` after the options are parsed, for options that contradict each other.
void afterParsing(CLI::App& app, const std::function<void()>& check);

/// Returns the given options with their values, as typed; without defaults and without the options in
/// `leftOut`.
std::vector<std::string> givenArguments(const CLI::App& app, const std::set<std::string>& leftOut = {});

/// A program without commands.
struct ProgramText {
  std::string name, version;
  std::string help;  // precedes the list of options
};

/// Parses the command line of a program. `declare` declares its options; `check` is called after parsing and refuses
/// options that contradict each other. --help, --version and errors are printed; the program then has to end with the
/// returned code.
std::optional<ExitCode> parseCommandLine(
    const ProgramText& program, int argc, char** argv, const std::function<void(CLI::App&)>& declare,
    const std::function<void()>& check = [] {});

/// Declares the options of all programs and commands: --json, --device, --disable-feature, --seed, --threads, -q, -v.
void declareCommonOptions(CLI::App& app, CommonOptions& options);

std::int64_t parsedInt(const std::string& option, const std::string& text, std::int64_t low, std::int64_t high);
double parsedDouble(const std::string& option, const std::string& text, double low, double high);
/// Parses a number of bytes, at least 1, with suffix K, M or G for 2^10, 2^20 or 2^30: 1500000, 800M, 1.5G.
std::uint64_t parsedBytes(const std::string& option, const std::string& text);

/// Declare a number; its description ends with the default.
Option addInt(CLI::App& app, const std::string& name, int& value, int low, int high, const std::string& description);
template <std::unsigned_integral T>
Option addCount(CLI::App& app, const std::string& name, T& value, T low, T high, const std::string& description) {
  return addParsed(
             app, name,
             [name, &value, low, high](const std::string& text) { value = T(parsedInt(name, text, low, high)); },
             description + " [" + std::to_string(value) + "]")
      .type("N");
}
Option addDouble(CLI::App& app, const std::string& name, double& value, double low, double high,
                 const std::string& description);

Option addBytes(CLI::App& app, const std::string& name, std::uint64_t& value, const std::string& description);

/// Size as WxH, such as 1280x720.
struct PictureSize {
  int width = 0, height = 0;  // 0: not given
};
Option addSize(CLI::App& app, const std::string& name, PictureSize& size, const std::string& description);

/// Declares --path auto:N: the number of views of a path made from the photographs.
Option addAutoPath(CLI::App& app, int& frames);

/// Declares --fov: degrees, 0 if not given.
Option addFov(CLI::App& app, double& degrees);

/// Declares --graph: the image graph is drawn over the images.
Option addGraph(CLI::App& app, bool& graph);

/// Declares an option that takes one of a few words.
template <class T>
Option addChoice(CLI::App& app, const std::string& name, T& value, std::vector<std::pair<std::string, T>> choices,
                 const std::string& description) {
  std::string words;
  for (const auto& [word, unused] : choices) words += (words.empty() ? "" : "|") + word;
  return addParsed(
             app, name,
             [name, words, choices, &value](const std::string& text) {
               for (const auto& [word, meaning] : choices)
                 if (word == text) {
                   value = meaning;
                   return;
                 }
               refuseOption(name, "'" + text + "' is not one of " + words);
             },
             description)
      .type(words);
}

}  // namespace ibr::app
