// SPDX-License-Identifier: Apache-2.0
#include "shared/cli/presets.h"

#include <fmt/ranges.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "shared/cli/setting_arguments.h"
#include "shared/cli/settings.h"

namespace ibr::app {
namespace {

constexpr std::array kDeviceKinds{std::pair{"software", DeviceKind::software},
                                  std::pair{"hardware", DeviceKind::hardware}};

// Returns the option's last value; "" if it was not given or the app lacks it.
std::string valueOf(const CLI::App& app, const char* option) {
  const CLI::Option* found = app.get_option_no_throw(option);
  return found && found->count() > 0 ? found->results().back() : std::string();
}

bool asksForCells(const CLI::App& app) {
  return valueOf(app, "--order") == "paper" || valueOf(app, "--colour").starts_with("paper") ||
         !valueOf(app, "--solo").empty();
}

// Parses a word of --preset, with or without the kind of a device.
RenderSettings presetNamed(const std::string& text, const CLI::App& app) {
  for (const auto& [word, meaning] : kPresets) {
    if (word == text) return preset(meaning, deviceKindFor(valueOf(app, "--device")));
    for (const auto& [kindWord, kind] : kDeviceKinds)
      if (text == std::string(word) + '-' + kindWord) return preset(meaning, kind);
  }
  throw CLI::ValidationError("--preset", "'" + text +
                                             "' is not one of fast|balanced|accurate|reference, with or without "
                                             "-software or -hardware");
}

// The preset that differs in the fewest options, and these options.
struct NearestPreset {
  std::string name, but;
  std::size_t differences = 0;
};

NearestPreset nearestPreset(const RenderSettings& settings) {
  const nlohmann::ordered_json ours = optionsJson(settings);
  std::optional<NearestPreset> nearest;
  for (const Preset chosen : {Preset::balanced, Preset::fast, Preset::accurate, Preset::reference})
    for (const auto& [word, kind] : kDeviceKinds) {
      const nlohmann::ordered_json theirs = optionsJson(preset(chosen, kind));
      nlohmann::ordered_json but;
      for (const auto& [name, value] : ours.items())
        if (value != theirs[name]) but[name] = value;
      if (!nearest || but.size() < nearest->differences)
        nearest = {presetName(chosen, kind), fmt::format("{}", fmt::join(settingArguments(but), " ")), but.size()};
    }
  return *nearest;
}

}  // namespace

void declarePreset(CLI::App& app, RenderSettings& settings, const std::optional<RenderSettings>& defaults) {
  settings = defaults.value_or(preset(Preset::balanced, DeviceKind::hardware));  // default that the help shows
  // Declared before the other settings, so that options given explicitly are applied later and override the preset.
  CLI::Option* option =
      app.add_option_function<std::string>(
             "--preset",
             [&app, &settings](const std::string& text) {
               // Help, and commands that are declared but not called, need no device.
               if (!app.parsed() || app.get_help_ptr()->count() > 0) return;
               settings = presetNamed(text, app);
               if (asksForCells(app)) settings.composition = Composition::cells;
             },
             "Preset of all settings, from fastest to most accurate; explicit options override the preset. Presets "
             "depend on the device, except with -software or -hardware, as balanced-software [balanced]")
          ->type_name("fast|balanced|accurate|reference");
  if (!defaults) option->default_str("balanced")->force_callback();
}

DeviceKind deviceKindFor(const std::string& selector) {
  const std::optional<DeviceDescription> device = Device::preferred(selector);
  return device ? deviceKindOf(device->type) : DeviceKind::software;
}

std::string presetName(Preset preset, DeviceKind kind) {
  if (ibr::preset(preset, DeviceKind::software) == ibr::preset(preset, DeviceKind::hardware))
    return kPresets[std::size_t(preset)].first;
  return fmt::format("{}-{}", kPresets[std::size_t(preset)].first, kDeviceKinds[std::size_t(kind)].first);
}

std::string presetName(const RenderSettings& settings) {
  return nearestPreset(settings).name;
}

std::string presetText(const RenderSettings& settings) {
  const NearestPreset nearest = nearestPreset(settings);
  return nearest.but.empty() ? nearest.name : nearest.name + " with " + nearest.but;
}

RenderSettings withPreset(const RenderSettings& settings, Preset preset, DeviceKind kind) {
  RenderSettings chosen = ibr::preset(preset, kind);
  chosen.overlay = settings.overlay;
  chosen.mutedCells = settings.mutedCells;
  chosen.soloCells = settings.soloCells;
  return chosen;
}

}  // namespace ibr::app
