// SPDX-License-Identifier: Apache-2.0
// Render settings by name: what each is differs by the kind of the device.
#pragma once

#include <CLI/CLI.hpp>
#include <array>
#include <optional>
#include <string>
#include <utility>

#include "ibr/renderer.h"

namespace ibr::app {

/// Words of --preset, from the fastest.
inline constexpr std::array kPresets{std::pair{"fast", Preset::fast}, std::pair{"balanced", Preset::balanced},
                                     std::pair{"accurate", Preset::accurate},
                                     std::pair{"reference", Preset::reference}};

/// A preset in the place of these settings; what is shown over the picture stays, and which cells are drawn.
RenderSettings presetOver(const RenderSettings& settings, Preset preset, DeviceKind kind);

/// --preset. `settings` becomes `defaults`, or as declareSettings says.
void declarePreset(CLI::App& app, RenderSettings& settings, const std::optional<RenderSettings>& defaults);

/// Kind of the device that --device names by `wish` (empty: without); software where there is none.
DeviceKind deviceKindFor(const std::string& wish);

/// "balanced-software", which --preset takes on any device; without the kind where it makes no difference.
std::string presetName(Preset preset, DeviceKind kind);
/// Of the preset that differs from these settings in the fewest options.
std::string presetName(const RenderSettings& settings);
/// That, and the options in which they differ: "balanced-software, but for --cells 4 --tiers 2".
std::string presetText(const RenderSettings& settings);

}  // namespace ibr::app
