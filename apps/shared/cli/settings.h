// SPDX-License-Identifier: Apache-2.0
// Render settings as options of a command and as a part of its report.
#pragma once

#include <CLI/CLI.hpp>
#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "ibr/renderer.h"
#include "shared/camera/up.h"

namespace ibr::app {

/// Declares all of them. `settings` becomes `defaults`; without them, when options have been read, the preset balanced
/// of the device that --device names, which is cells where an option asks for what is theirs alone (the paper's ways,
/// --solo).
void declareSettings(CLI::App& app, RenderSettings& settings, const std::optional<RenderSettings>& defaults = {});

/// The same without --cells, --order and --colour, for a command that tries several of each.
void declarePictureSettings(CLI::App& app, RenderSettings& settings,
                            const std::optional<RenderSettings>& defaults = {});

/// --overlay, --mute and --solo, for programs whose pictures are looked at.
void declareOverlays(CLI::App& app, RenderSettings& settings);

/// Not with the paper's ways of colour mapping.
bool overlaysGoWith(const RenderSettings& settings);
/// Throws CLI::ValidationError where there is one and it does not go with the other settings.
void checkOverlays(const RenderSettings& settings);
/// Throws Error{invalidInput} where --mute or --solo names a cell that the scene does not have.
void checkCells(const RenderSettings& settings, const Scene& scene);

/// --vram-budget, --blocks and --filter, for all commands that put a scene on a device.
void declareGpuScene(CLI::App& app, GpuSceneOptions& options);

/// --texture, for commands that write textures.
void declareTextureFormat(CLI::App& app, TextureFormat& format);

/// Words of --colour, also of reports.
inline constexpr std::array kColourMappings{
    std::pair{"off", ColourMapping::off}, std::pair{"ours", ColourMapping::ours},
    std::pair{"paper", ColourMapping::paper}, std::pair{"paper-redraw", ColourMapping::paperRedraw}};
const char* wordOf(ColourMapping mapping);

/// Words of --exposure, also of reports.
inline constexpr std::array kExposures{std::pair{"off", Exposure::off}, std::pair{"scene", Exposure::scene},
                                       std::pair{"adapted", Exposure::adapted}};
const char* wordOf(Exposure exposure);
const char* wordOf(BlendMode blend);
const char* wordOf(Composition composition);
/// After the last comes the first.
Composition next(Composition composition);

/// Words of --overlay and what each shows, in the order in which a viewer goes through them.
struct OverlayWord {
  Overlay overlay;
  const char* word;
  const char* shows;
};
inline constexpr std::array kOverlays{
    OverlayWord{Overlay::none, "none", "the picture alone"},
    OverlayWord{Overlay::wireframe, "wireframe", "edges of the triangles, the better their cell's rank the lighter"},
    OverlayWord{Overlay::tiers, "tiers", "what photographs agree on, what was completed, holes"},
    OverlayWord{Overlay::weights, "weights", "which photographs of a cell the picture comes from"},
    OverlayWord{Overlay::confidence, "confidence", "how certain the depth is"},
    OverlayWord{Overlay::depth, "depth", "how far away it is"},
    OverlayWord{Overlay::overlap, "overlap", "how many cells show a place"},
    OverlayWord{Overlay::agreement, "agreement", "how well a cell's photographs correlate there"}};
const OverlayWord& wordOf(Overlay overlay);

/// How pictures are drawn, each setting under the name of its option.
nlohmann::ordered_json optionsJson(const RenderSettings& settings);

/// That, "preset" (presetName) before it and how the scene is held after it: the effective settings.
nlohmann::ordered_json settingsJson(const RenderSettings& settings, const GpuSceneOptions& gpuScene);

/// These, "floor" and "floorSpacing" (FloorWish), "overlay", each null where there is none,
/// "mute" and "solo", lists of cells: all that makes one picture of a view.
nlohmann::ordered_json pictureSettingsJson(const RenderSettings& settings, const GpuSceneOptions& gpuScene,
                                           const std::optional<FloorWish>& floor);

}  // namespace ibr::app
