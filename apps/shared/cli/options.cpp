// SPDX-License-Identifier: Apache-2.0
#include "shared/cli/options.h"

#include <fmt/ranges.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "ibr/device.h"
#include "shared/cli/context.h"

namespace ibr::app {
namespace {

// Uses the environment, so that the list holds for all devices of this program and of the programs it starts.
void disableFeatures(const std::string& list) {
  try {
    Device::disabledFeatures(list);
  } catch (const Error& e) {
    throw CLI::ValidationError("--disable-feature", e.what());
  }
  ::setenv("IBR_DISABLE_FEATURES", list.c_str(), 1);
}

}  // namespace

std::int64_t parsedInt(const std::string& option, const std::string& text, std::int64_t low, std::int64_t high) {
  const auto value = parseInt(text);
  if (!value || *value < low || *value > high)
    throw CLI::ValidationError(option, fmt::format("'{}' is not a whole number from {} to {}", text, low, high));
  return *value;
}

double parsedDouble(const std::string& option, const std::string& text, double low, double high) {
  const auto value = parseDouble(text);
  if (!value || *value < low || *value > high)
    throw CLI::ValidationError(option, fmt::format("'{}' is not a number from {} to {}", text, low, high));
  return *value;
}

std::optional<ExitCode> parsed(CLI::App& app, int argc, char** argv, const std::function<void()>& check) {
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
    const std::string& name = app.get_name();
    return printError(name, fmt::format("{}\n{}: {} --help lists the options", e.what(), name, name), kExitCommandLine);
  }
}

CLI::Option* addInt(CLI::App& app, const std::string& name, int& value, int low, int high,
                    const std::string& description) {
  return app
      .add_option_function<std::string>(
          name, [name, &value, low, high](const std::string& text) { value = int(parsedInt(name, text, low, high)); },
          fmt::format("{} [{}]", description, value))
      ->type_name("N");
}

CLI::Option* addDouble(CLI::App& app, const std::string& name, double& value, double low, double high,
                       const std::string& description) {
  return app
      .add_option_function<std::string>(
          name, [name, &value, low, high](const std::string& text) { value = parsedDouble(name, text, low, high); },
          fmt::format("{} [{}]", description, value))
      ->type_name("X");
}

void declareCommonOptions(CLI::App& app, CommonOptions& options) {
  app.add_option("--json", options.json, "Write the report as JSON to FILE, or - for stdout")->type_name("FILE");
  app.add_option("--device", options.device,
                 "Vulkan device, by number or by part of its name (ibr doctor lists the "
                 "devices)")
      ->type_name("NAME");
  app.add_option_function<std::string>("--disable-feature", disableFeatures,
                                       fmt::format("Optional device features to leave unused, separated by commas: {}; "
                                                   "same as IBR_DISABLE_FEATURES",
                                                   fmt::join(Device::optionalFeatureNames(), ", ")))
      ->type_name("LIST");
  app.add_option_function<std::string>(
         "--seed",
         [&options](const std::string& text) { options.seed = std::uint64_t(parsedInt("--seed", text, 0, INT64_MAX)); },
         "Seed of all random numbers [1]")
      ->type_name("N");
  addInt(app, "--threads", options.threads, 0, 1024, "Number of CPU threads; 0 = all cores");
  app.add_flag("-q,--quiet", options.quiet, "Print only errors");
  app.add_flag("-v,--verbose", options.verbose, "Print more messages");
}

bool isSet(const CLI::Option& option) {
  if (option.count() == 0) return false;
  return !option.get_force_callback() || option.results()[0] != option.get_default_str();
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
    throw CLI::ValidationError(option, fmt::format("'{}' is not a number of bytes such as 800M or 1.5G", text));
  return std::uint64_t(*value * unit);
}

CLI::Option* addBytes(CLI::App& app, const std::string& name, std::uint64_t& value, const std::string& description) {
  return app
      .add_option_function<std::string>(
          name, [name, &value](const std::string& text) { value = parsedBytes(name, text); }, description)
      ->type_name("BYTES");
}

CLI::Option* addSize(CLI::App& app, const std::string& name, PictureSize& size, const std::string& description) {
  return app
      .add_option_function<std::string>(
          name,
          [name, &size](const std::string& text) {
            const auto cross = text.find('x');
            if (cross == std::string::npos)
              throw CLI::ValidationError(name, fmt::format("'{}' is not a size such as 1280x720", text));
            size.width = int(parsedInt(name, text.substr(0, cross), 1, 16384));
            size.height = int(parsedInt(name, text.substr(cross + 1), 1, 16384));
          },
          description)
      ->type_name("WxH");
}

CLI::Option* addAutoPath(CLI::App& app, int& frames) {
  return app
      .add_option_function<std::string>(
          "--path",
          [&frames](const std::string& text) {
            const std::string prefix = "auto:";
            if (!text.starts_with(prefix))
              throw CLI::ValidationError("--path", "'" + text + "' is not of the form auto:N");
            frames = int(parsedInt("--path", text.substr(prefix.size()), 1, 1'000'000));
          },
          "Automatic path of N views, between and slightly beyond the photographs")
      ->type_name("auto:N");
}

CLI::Option* addFov(CLI::App& app, double& degrees) {
  return app
      .add_option_function<std::string>(
          "--fov", [&degrees](const std::string& text) { degrees = parsedDouble("--fov", text, 1, 179); },
          "Vertical field of view, as if the principal point were centred [from the poses]")
      ->type_name("DEGREES");
}

void addGraph(CLI::App& app, bool& graph) {
  app.add_flag(
      "--graph", graph,
      "Draw the image graph over the images: camera frusta and cell edges, with the cells in use coloured by rank");
}

std::vector<CLI::Option*> inGroup(CLI::App& app, const std::string& group, const std::function<void()>& declare) {
  const std::size_t before = app.get_options().size();
  declare();
  std::vector<CLI::Option*> options = app.get_options();
  options.erase(options.begin(), options.begin() + std::ptrdiff_t(before));
  for (CLI::Option* option : options) option->group(group);
  return options;
}

void refuseIfSet(const std::vector<CLI::Option*>& options, const std::string& why) {
  for (const CLI::Option* option : options)
    if (isSet(*option)) throw CLI::ValidationError(option->get_name(), why);
}

}  // namespace ibr::app
