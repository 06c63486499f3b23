// SPDX-License-Identifier: Apache-2.0
// Render settings by name. A preset's values differ by the kind of the device.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>

#include "ibr/renderer.h"
#include "shared/cli/cli_fwd.h"

namespace ibr::app {

/// Words of --preset, from the fastest to the most accurate.
inline constexpr std::array kPresets{std::pair{"fast", Preset::fast}, std::pair{"balanced", Preset::balanced},
                                     std::pair{"accurate", Preset::accurate},
                                     std::pair{"reference", Preset::reference}};

/// Returns the preset; keeps from `settings` the overlays and the choice of cells to draw.
RenderSettings withPreset(const RenderSettings& settings, Preset preset, DeviceKind kind);

/// Declares --preset. `settings` is set to `defaults`, or as declareSettings describes.
void declarePreset(CLI::App& app, RenderSettings& settings, const std::optional<RenderSettings>& defaults);

/// Returns the kind of the device that --device selects by `selector` (empty: no --device); software if there is none.
DeviceKind deviceKindFor(const std::string& selector);

/// Returns a name such as "balanced-software", valid for --preset on any device; no kind if all kinds are the same.
std::string presetName(Preset preset, DeviceKind kind);
/// Returns the name of the preset that differs from these settings in the fewest options.
std::string presetName(const RenderSettings& settings);
/// Returns this name and the differing options: "balanced-software with --cells 4 --tiers 2".
std::string presetText(const RenderSettings& settings);

}  // namespace ibr::app
