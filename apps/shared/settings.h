// SPDX-License-Identifier: Apache-2.0
// Render settings as options of a command and as a part of its report.
#pragma once

#include <CLI/CLI.hpp>
#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "ibr/renderer.h"

namespace ibr::app {

/// All of them.
void declareSettings(CLI::App& app, RenderSettings& settings);

/// Without --cells, --order and --colour, for a command that tries several of each.
void declarePictureSettings(CLI::App& app, RenderSettings& settings);

/// --vram-budget, --blocks and --filter, for all commands that put a scene on a device.
void declareGpuScene(CLI::App& app, GpuSceneOptions& options);

/// --texture, for commands that write textures.
void declareTextureFormat(CLI::App& app, TextureFormat& format);

/// Words of --preset, from the fastest.
inline constexpr std::array kPresets{std::pair{"fast", Preset::fast}, std::pair{"balanced", Preset::balanced},
                                     std::pair{"accurate", Preset::accurate},
                                     std::pair{"reference", Preset::reference}};

/// A preset in the place of these settings; what is shown over the picture stays.
RenderSettings presetOver(const RenderSettings& settings, Preset preset);

/// Words of --colour, also of reports.
inline constexpr std::array kColourMappings{
    std::pair{"off", ColourMapping::off}, std::pair{"ours", ColourMapping::ours},
    std::pair{"paper", ColourMapping::paper}, std::pair{"paper-redraw", ColourMapping::paperRedraw}};
const char* wordOf(ColourMapping mapping);
const char* wordOf(BlendMode blend);

/// The effective settings, each under the name of its option.
nlohmann::ordered_json settingsJson(const RenderSettings& settings, const GpuSceneOptions& gpuScene);

/// These, "floor" (--floor: its eye height in world units, null where there is none) and "wireframe": all that makes
/// one picture of a view.
nlohmann::ordered_json pictureSettingsJson(const RenderSettings& settings, const GpuSceneOptions& gpuScene,
                                           double eyeHeight);

}  // namespace ibr::app
