// SPDX-License-Identifier: Apache-2.0
// Render settings as command-line options and as a part of the report.
#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <utility>

#include "ibr/renderer.h"
#include "shared/camera/up.h"
#include "shared/cli/cli_fwd.h"

namespace ibr::app {

/// Declares the render settings. `settings` is set to `defaults`. Without defaults, the preset `balanced` of the device
/// of --device is set when the options are parsed; with --solo its composition becomes cells.
void declareSettings(CLI::App& app, RenderSettings& settings, const std::optional<RenderSettings>& defaults = {});

/// As declareSettings, with the paper's methods, which make the composition cells, and the parameters of colour tables:
/// for `ibr eval` and `ibr-lab sweep`.
void declareAllSettings(CLI::App& app, RenderSettings& settings, const std::optional<RenderSettings>& defaults = {});

/// Keys in reports of the settings that only declareAllSettings declares.
inline constexpr std::array kMeasuredSettings{"morph",         "order",       "eyeColours",  "colourTable",
                                              "colourSamples", "colourProxy", "colourPeriod"};

/// As declareSettings, without --cells and --colour, for commands that compare several values of these.
void declarePictureSettings(CLI::App& app, RenderSettings& settings,
                            const std::optional<RenderSettings>& defaults = {});

/// Declares --overlay, --mute and --solo, for programs whose images are viewed by people.
void declareOverlays(CLI::App& app, RenderSettings& settings);

/// Throws Error{invalidInput} if --mute or --solo names a cell that the scene lacks.
void checkCells(const RenderSettings& settings, const Scene& scene);

/// Declares --vram-budget, --blocks and --filter, for all commands that load a scene onto a device.
void declareGpuScene(CLI::App& app, GpuSceneOptions& options);

/// Declares --texture, for commands that write textures.
void declareTextureFormat(CLI::App& app, TextureFormat& format);

/// Words of --colour, also in reports.
inline constexpr std::array kColourMappings{
    std::pair{"off", ColourMapping::off}, std::pair{"ours", ColourMapping::ours},
    std::pair{"paper", ColourMapping::paper}, std::pair{"paper-redraw", ColourMapping::paperRedraw}};
const char* optionValue(ColourMapping mapping);

/// Words of --exposure, also in reports.
inline constexpr std::array kExposures{std::pair{"off", Exposure::off}, std::pair{"scene", Exposure::scene},
                                       std::pair{"adapted", Exposure::adapted}};
const char* optionValue(Exposure exposure);
const char* optionValue(BlendMode blend);
const char* optionValue(Composition composition);
/// Returns the next composition, cyclic.
Composition next(Composition composition);

/// Words of --overlay and their descriptions, in the order in which the viewer cycles through them.
struct OverlayOption {
  Overlay overlay;
  const char* word;
  const char* shows;
};
inline constexpr std::array kOverlays{
    OverlayOption{Overlay::none, "none", "the image alone"},
    OverlayOption{Overlay::wireframe, "wireframe", "triangle edges, lighter for cells of better rank"},
    OverlayOption{Overlay::tiers, "tiers", "confirmed depth, completed depth, holes"},
    OverlayOption{Overlay::weights, "weights", "weights of a cell's photographs in each pixel"},
    OverlayOption{Overlay::confidence, "confidence", "confidence of the depth"},
    OverlayOption{Overlay::depth, "depth", "distance along the viewing axis"},
    OverlayOption{Overlay::overlap, "overlap", "number of cells that show a pixel"},
    OverlayOption{Overlay::agreement, "agreement", "correlation of a cell's photographs around a pixel"}};
const OverlayOption& optionValue(Overlay overlay);

/// Returns the drawing settings, each under the name of its option.
nlohmann::ordered_json optionsJson(const RenderSettings& settings);

/// Returns all effective settings: "preset" (presetName), the drawing settings, and the GPU scene's options.
nlohmann::ordered_json settingsJson(const RenderSettings& settings, const GpuSceneOptions& gpuScene);

/// Returns all settings that determine the image of a view: those of settingsJson, "floor" and "floorSpacing"
/// (FloorOptions), "overlay", each null if absent, and "mute" and "solo", lists of cells.
nlohmann::ordered_json pictureSettingsJson(const RenderSettings& settings, const GpuSceneOptions& gpuScene,
                                           const std::optional<FloorOptions>& floor);

}  // namespace ibr::app
