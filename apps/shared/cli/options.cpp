// SPDX-License-Identifier: Apache-2.0
#include "shared/cli/options.h"

#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "base/parse.h"
#include "ibr/device.h"
#include "shared/cli/context.h"
#include "shared/cli/describe.h"
#include "shared/cli/near_name.h"

namespace ibr::app {
namespace {

// Uses the environment, so that the list holds for all devices of this program and of the programs it starts.
void disableFeatures(const std::string& list) {
  try {
    Device::disabledFeatures(list);
  } catch (const Error& e) {
    refuseOption("--disable-feature", e.what());
  }
  ::setenv("IBR_DISABLE_FEATURES", list.c_str(), 1);
}

bool isSet(const CLI::Option& option) {
  if (option.count() == 0) return false;
  return !option.get_force_callback() || option.results()[0] != option.get_default_str();
}

}  // namespace

Option Option::required() const {
  return Option(option_->required());
}

Option Option::type(const std::string& word) const {
  return Option(option_->type_name(word));
}

Option Option::delimiter(char separator) const {
  return Option(option_->delimiter(separator));
}

Option Option::expected(int count) const {
  return Option(option_->expected(count));
}

Option Option::expected(int min, int max) const {
  return Option(option_->expected(min, max));
}

Option Option::range(int low, int high) const {
  return Option(option_->check(CLI::Range(low, high)));
}

Option Option::oneOf(const std::vector<std::string>& words) const {
  return Option(option_->check(CLI::IsMember(words)));
}

Option Option::check(const std::function<void(const std::string&)>& check) const {
  return Option(option_->check([check](const std::string& value) {
    check(value);
    return std::string();  // CLI11 expects the error, or "" for a good value
  }));
}

Option Option::needs(Option other) const {
  return Option(option_->needs(other.option_));
}

Option Option::excludes(Option other) const {
  return Option(option_->excludes(other.option_));
}

Option Option::excludes(const std::string& other) const {
  return Option(option_->excludes(other));
}

Option Option::group(const std::string& heading) const {
  return Option(option_->group(heading));
}

std::string Option::name() const {
  return option_->get_name();
}

bool Option::isSet() const {
  return app::isSet(*option_);
}

void refuseOption(const std::string& name, const std::string& message) {
  throw CLI::ValidationError(name, message);
}

void refuseOptions(const std::string& message) {
  throw CLI::ValidationError(message);
}

void requireOption(const std::string& name) {
  throw CLI::RequiredError(name);
}

void refuseIfSet(const std::vector<Option>& options, const std::string& why) {
  for (const Option& option : options)
    if (option.isSet()) refuseOption(option.name(), why);
}

Option addOption(CLI::App& app, const std::string& name, std::string& value, const std::string& description) {
  return Option(app.add_option(name, value, description));
}

Option addOption(CLI::App& app, const std::string& name, std::vector<std::string>& values,
                 const std::string& description) {
  return Option(app.add_option(name, values, description));
}

Option addOption(CLI::App& app, const std::string& name, std::vector<int>& values, const std::string& description) {
  return Option(app.add_option(name, values, description));
}

Option addOption(CLI::App& app, const std::string& name, std::filesystem::path& value, const std::string& description) {
  return Option(app.add_option(name, value, description));
}

Option addOption(CLI::App& app, const std::string& name, std::size_t& value, const std::string& description) {
  return Option(app.add_option(name, value, description));
}

Option addParsed(CLI::App& app, const std::string& name, const std::function<void(const std::string&)>& parse,
                 const std::string& description) {
  return Option(app.add_option_function<std::string>(name, parse, description));
}

Option addParsedList(CLI::App& app, const std::string& name,
                     const std::function<void(const std::vector<std::string>&)>& parse,
                     const std::string& description) {
  return Option(app.add_option_function<std::vector<std::string>>(name, parse, description));
}

Option addFlag(CLI::App& app, const std::string& name, bool& value, const std::string& description) {
  return Option(app.add_flag(name, value, description));
}

Option addFlag(CLI::App& app, const std::string& name, std::string& value, const std::string& description) {
  return Option(app.add_flag(name, value, description));
}

Option addFlagCallback(CLI::App& app, const std::string& name, const std::function<void()>& given,
                       const std::string& description) {
  return Option(app.add_flag_callback(name, given, description));
}

void removeOption(CLI::App& app, const std::string& name) {
  app.remove_option(app.get_option(name));
}

std::vector<Option> declaredBy(CLI::App& app, const std::function<void()>& declare) {
  const std::size_t before = app.get_options().size();
  declare();
  const std::vector<CLI::Option*> all = app.get_options();
  std::vector<Option> declared;
  for (std::size_t i = before; i < all.size(); ++i) declared.emplace_back(all[i]);
  return declared;
}

std::vector<Option> inGroup(CLI::App& app, const std::string& group, const std::function<void()>& declare) {
  const std::vector<Option> options = declaredBy(app, declare);
  for (const Option& option : options) option.group(group);
  return options;
}

void passArgumentsOn(CLI::App& app) {
  app.prefix_command();  // keeps the order of the arguments
}

std::vector<std::string> remainingArguments(const CLI::App& app) {
  return app.remaining();
}

void afterParsing(CLI::App& app, const std::function<void()>& check) {
  app.callback(check);
}

std::vector<std::string> givenArguments(const CLI::App& app, const std::set<std::string>& leftOut) {
  std::vector<std::string> words;
  for (const CLI::Option* option : app.get_options()) {
    if (!isSet(*option) || leftOut.contains(option->get_name())) continue;
    const bool flag = option->get_items_expected_max() == 0;
    if (!option->get_positional() && !flag) words.push_back(option->get_name());
    for (const std::string& value : option->results())
      words.push_back(!flag ? value : value == "true" ? option->get_name() : option->get_name() + "=" + value);
  }
  return words;
}

std::optional<ExitCode> parseCommandLine(const ProgramText& program, int argc, char** argv,
                                         const std::function<void(CLI::App&)>& declare,
                                         const std::function<void()>& check) {
  CLI::App app(program.help, program.name);
  app.set_version_flag("--version", program.name + ' ' + program.version);
  declare(app);
  if (argc == 2 && argv[1] == kDescribe) {
    printDescription({{"program", program.name},
                      {"version", program.version},
                      {"help", program.help},
                      {"options", describeOptions(app)},
                      {"exitCodes", describeExitCodes()}});
    return kExitOk;
  }
  try {
    app.parse(argc, argv);
    check();
    return std::nullopt;
  } catch (const CLI::Success& e) {
    const bool version = dynamic_cast<const CLI::CallForVersion*>(&e);
    std::fputs(version ? (std::string(e.what()) + '\n').c_str() : app.help().c_str(), stdout);
    flushResults();
    return kExitOk;
  } catch (const CLI::ParseError& e) {
    const std::string& name = program.name;
    const std::string fault = misspeltOption(app, {argv + 1, argv + argc}).value_or(e.what());
    return printError(name, fmt::format("{}\n{}: {} --help lists the options", fault, name, name), kExitCommandLine);
  }
}

std::int64_t parsedInt(const std::string& option, const std::string& text, std::int64_t low, std::int64_t high) {
  const auto value = parseInt(text);
  if (!value || *value < low || *value > high)
    refuseOption(option, fmt::format("'{}' is not a whole number from {} to {}", text, low, high));
  return *value;
}

double parsedDouble(const std::string& option, const std::string& text, double low, double high) {
  const auto value = parseDouble(text);
  if (!value || *value < low || *value > high)
    refuseOption(option, fmt::format("'{}' is not a number from {} to {}", text, low, high));
  return *value;
}

Option addInt(CLI::App& app, const std::string& name, int& value, int low, int high, const std::string& description) {
  return addParsed(
             app, name,
             [name, &value, low, high](const std::string& text) { value = int(parsedInt(name, text, low, high)); },
             fmt::format("{} [{}]", description, value))
      .type("N");
}

Option addDouble(CLI::App& app, const std::string& name, double& value, double low, double high,
                 const std::string& description) {
  return addParsed(
             app, name,
             [name, &value, low, high](const std::string& text) { value = parsedDouble(name, text, low, high); },
             fmt::format("{} [{}]", description, value))
      .type("X");
}

void declareCommonOptions(CLI::App& app, CommonOptions& options) {
  addOption(app, "--json", options.json, "Write the report as JSON to FILE, or - for stdout").type("FILE");
  addOption(app, "--device", options.device,
            "Vulkan device, by number or by part of its name (ibr doctor lists the "
            "devices)")
      .type("NAME");
  addParsed(app, "--disable-feature", disableFeatures,
            fmt::format("Optional device features to leave unused, separated by commas: {}; "
                        "same as IBR_DISABLE_FEATURES",
                        fmt::join(Device::optionalFeatureNames(), ", ")))
      .type("LIST");
  addParsed(
      app, "--seed",
      [&options](const std::string& text) { options.seed = std::uint64_t(parsedInt("--seed", text, 0, INT64_MAX)); },
      "Seed of all random numbers [1]")
      .type("N");
  addInt(app, "--threads", options.threads, 0, 1024, "Number of CPU threads; 0 = all cores");
  addFlag(app, "-q,--quiet", options.quiet, "Print only errors");
  addFlag(app, "-v,--verbose", options.verbose, "Print more messages");
}

std::uint64_t parsedBytes(const std::string& option, const std::string& text) {
  std::string digits = text;
  double unit = 1;
  const std::string letters = "KMG";
  if (const auto letter = digits.empty() ? std::string::npos : letters.find(digits.back());
      letter != std::string::npos) {
    unit = std::exp2(10.0 * double(letter + 1));
    digits.pop_back();
  }
  const auto value = parseDouble(digits);
  if (!value || *value * unit < 1 || *value * unit > 1e15)
    refuseOption(option, fmt::format("'{}' is not a number of bytes such as 800M or 1.5G", text));
  return std::uint64_t(*value * unit);
}

Option addBytes(CLI::App& app, const std::string& name, std::uint64_t& value, const std::string& description) {
  return addParsed(
             app, name, [name, &value](const std::string& text) { value = parsedBytes(name, text); }, description)
      .type("BYTES");
}

Option addSize(CLI::App& app, const std::string& name, PictureSize& size, const std::string& description) {
  return addParsed(
             app, name,
             [name, &size](const std::string& text) {
               const auto cross = text.find('x');
               if (cross == std::string::npos)
                 refuseOption(name, fmt::format("'{}' is not a size such as 1280x720", text));
               size.width = int(parsedInt(name, text.substr(0, cross), 1, 16384));
               size.height = int(parsedInt(name, text.substr(cross + 1), 1, 16384));
             },
             description)
      .type("WxH");
}

Option addAutoPath(CLI::App& app, int& frames) {
  return addParsed(
             app, "--path",
             [&frames](const std::string& text) {
               const std::string prefix = "auto:";
               if (!text.starts_with(prefix)) refuseOption("--path", "'" + text + "' is not of the form auto:N");
               frames = int(parsedInt("--path", text.substr(prefix.size()), 1, 1'000'000));
             },
             "Automatic path of N views, between and slightly beyond the photographs")
      .type("auto:N");
}

Option addFov(CLI::App& app, double& degrees) {
  return addParsed(
             app, "--fov", [&degrees](const std::string& text) { degrees = parsedDouble("--fov", text, 1, 179); },
             "Vertical field of view, as if the principal point were centred [from the poses]")
      .type("DEGREES");
}

Option addGraph(CLI::App& app, bool& graph) {
  return addFlag(
      app, "--graph", graph,
      "Draw the image graph over the images: camera frusta and cell edges, with the cells in use coloured by rank");
}

}  // namespace ibr::app
