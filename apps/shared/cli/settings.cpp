// SPDX-License-Identifier: Apache-2.0
#include "shared/cli/settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/check.h"
#include "shared/cli/options.h"
#include "shared/cli/presets.h"

namespace ibr::app {

namespace {

static_assert([] {
  for (std::size_t i = 0; i < kOverlays.size(); ++i)
    if (std::size_t(kOverlays[i].overlay) != i) return false;
  return true;
}());

// Parses a list of cells such as "3,7".
std::vector<std::uint32_t> parsedCells(const std::string& option, const std::string& text) {
  std::vector<std::uint32_t> cells;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t comma = std::min(text.find(',', from), text.size());
    cells.push_back(std::uint32_t(parsedInt(option, text.substr(from, comma - from), 0, 1000000000)));
    from = comma + 1;
  }
  return cells;
}

}  // namespace

void declarePictureSettings(CLI::App& app, RenderSettings& settings, const std::optional<RenderSettings>& defaults) {
  declarePreset(app, settings, defaults);
  addChoice<Composition>(
      app, "--composition", settings.composition,
      {{"cells", Composition::cells}, {"gathered", Composition::gathered}, {"hybrid", Composition::hybrid}},
      "Source of pixels: morphing cells, a gather from photographs per pixel, or cells with a gather where members "
      "disagree [as --preset]");
  addCount<std::uint32_t>(app, "--photographs", settings.gatherCandidates, 1, kMaxGatherCandidates,
                          "Maximum number of photographs per frame to gather from");
  addCount<std::uint32_t>(app, "--colours", settings.gatherColours, 1, kMaxGatherColours,
                          "Maximum number of photographs averaged in a gathered pixel");
  addCount<std::uint32_t>(app, "--layers", settings.gatherLayers, 1, kMaxGatherLayers,
                          "Maximum number of surfaces behind one another in a gathered pixel");
  addDouble(app, "--vote-scale", settings.voteScale, 0.05, 1,
            "Size of the image in which photographs vote for depth, as a factor on the drawn image's sides; 0.25 with "
            "balanced-software");
  addInt(app, "--tiers", settings.maxTier, kTierConsistent, kTierFilled,
         "Draw tiers 0 to N: 0 confirmed by several photographs, 2 adds gathered pixels of unconfirmed depth, 3 fills "
         "holes from around, except in scenes with masks");
  addChoice<bool>(app, "--align", settings.alignCells, {{"on", true}, {"off", false}},
                  "Shift cells that share photographs slightly until the cells agree, for inaccurate poses [off]");
  addChoice<BlendMode>(app, "--blend", settings.blend,
                       {{"blend", BlendMode::blend}, {"dither", BlendMode::dither}, {"mixed", BlendMode::mixed}},
                       "Combine photographs by a weighted sum (blend), by one photograph per pixel (dither), or by the "
                       "mean of both [blend]");
  addDouble(app, "--extrapolation", settings.extrapolationLimit, 0, 1e6,
            "Draw no cell that is farther away than X times its size");
  addDouble(app, "--switch", settings.switchSeconds, 0, 60,
            "Along a path, seconds of the cross-fade after the main cell changes; 0: cut");
  addDouble(app, "--texture-scale", settings.textureScale, 0.01, 100,
            "Share of the photographs' detail to show: 0.5 uses textures of half the size");
  addDouble(app, "--render-scale", settings.renderScale, 0.05, 4,
            "Size of the drawn image, as a factor on the result's sides; the drawn image is then scaled");
  addChoice<Exposure>(
      app, "--exposure", settings.exposure,
      [] {
        std::vector<std::pair<std::string, Exposure>> choices;
        for (const auto& [word, exposure] : kExposures) choices.emplace_back(word, exposure);
        return choices;
      }(),
      "Exposure of the photographs: unchanged (off), the mean of the scene, or the mean of the photographs in the main "
      "cell [adapted]");
}

void declareSettings(CLI::App& app, RenderSettings& settings, const std::optional<RenderSettings>& defaults) {
  declarePictureSettings(app, settings, defaults);
  addCount<std::uint32_t>(app, "--cells", settings.maxCells, 1, kMaxCellCount,
                          "Maximum number of cells to draw; the "
                          "hybrid composition draws at most 2");
  addChoice<ColourMapping>(app, "--colour", settings.colourMapping,
                           {{"off", ColourMapping::off}, {"ours", ColourMapping::ours}},
                           "Match colours of all cells to the main cell by tables from a proxy image (ours) [off]");
}

void declareAllSettings(CLI::App& app, RenderSettings& settings, const std::optional<RenderSettings>& defaults) {
  declareSettings(app, settings, defaults);
  addChoice<Morph>(
      app, "--morph", settings.morph, {{"ours", Morph::ours}, {"paper", Morph::paper}},
      "Position of morphed vertices: by inverse distances (ours), or by equation 4 of the paper, which excludes "
      "--align [ours]");
  addChoice<DrawOrder>(
      app, "--order", settings.order, {{"ours", DrawOrder::ours}, {"paper", DrawOrder::paper}},
      "Draw order: main cell first with a depth test (ours), or the paper's back to front without one, with "
      "--composition cells [ours]");
  removeOption(app, "--colour");
  addChoice<ColourMapping>(
      app, "--colour", settings.colourMapping, {kColourMappings.begin(), kColourMappings.end()},
      "Match colours of all cells to the main cell: tables from a proxy image (ours), or the paper's sequence, applied "
      "per pixel (paper) or by redrawing, both with --composition cells [off]");
  addChoice<ColourTable>(
      app, "--colour-table", settings.colourTable,
      {{"naive", ColourTable::naive}, {"strict", ColourTable::strict}, {"preserving", ColourTable::preserving}},
      "Extrapolation of colour tables beyond the colours that cells share [preserving]");
  addDouble(app, "--colour-samples", settings.colourSamples, 0, 1,
            "Share of an overlap's pixels that colour tables are computed from");
  addInt(app, "--colour-proxy", settings.colourProxy, 1, 64,
         "--colour ours: factor by which the proxy image, from which colour tables are computed, is smaller in width "
         "and height");
  addInt(app, "--colour-period", settings.colourPeriod, 1, 1000,
         "--colour ours: along a path, number of frames after which colour tables are computed again");
  addChoice<bool>(app, "--eye-colours", settings.shareEyeColours, {{"shared", true}, {"own", false}},
                  "With two views: one colour table for both views, or one for each [shared]");
}

void declareOverlays(CLI::App& app, RenderSettings& settings) {
  std::vector<std::pair<std::string, Overlay>> choices;
  std::string description = "Diagnostic image over the rendered image or in its place [none]:";
  for (const OverlayOption& line : kOverlays) {
    choices.emplace_back(line.word, line.overlay);
    if (line.overlay != Overlay::none) description += fmt::format("\n{}: {}", line.word, line.shows);
  }
  addChoice<Overlay>(app, "--overlay", settings.overlay, std::move(choices), description).type("NAME");
  const auto cells = [&app](const char* name, std::vector<std::uint32_t>& value, const char* what) {
    addParsed(
        app, name, [name, &value](const std::string& text) { value = parsedCells(name, text); }, what)
        .type("N,N…");
  };
  cells("--mute", settings.mutedCells, "Never draw these cells");
  cells("--solo", settings.soloCells, "Draw only these cells; sets --composition cells");
}

void checkCells(const RenderSettings& settings, const Scene& scene) {
  const std::size_t n = scene.cells.size();
  for (const auto& [name, cells] : {std::pair{"--mute", &settings.mutedCells}, {"--solo", &settings.soloCells}})
    for (const std::uint32_t cell : *cells)
      check(cell<n, ErrorCode::invalidInput, "{} {}: the scene has {} cells, 0 to {}", name, cell, n, n> 0 ? n - 1 : 0);
}

const OverlayOption& optionValue(Overlay overlay) {
  return kOverlays[std::size_t(overlay)];
}

const char* optionValue(ColourMapping mapping) {
  for (const auto& [word, meaning] : kColourMappings)
    if (meaning == mapping) return word;
  return "";
}

const char* optionValue(Exposure exposure) {
  return kExposures[std::size_t(exposure)].first;
}

const char* optionValue(Composition composition) {
  return composition == Composition::cells ? "cells" : composition == Composition::gathered ? "gathered" : "hybrid";
}

Composition next(Composition composition) {
  return composition == Composition::hybrid ? Composition::cells : Composition(int(composition) + 1);
}

const char* optionValue(BlendMode blend) {
  return blend == BlendMode::blend ? "blend" : blend == BlendMode::dither ? "dither" : "mixed";
}

void declareGpuScene(CLI::App& app, GpuSceneOptions& options) {
  addBytes(app, "--vram-budget", options.budgetBytes,
           "Maximum device memory for the scene, in bytes (K, M, G for 2^10, 2^20, 2^30); photographs, depth "
           "textures and meshes that do not fit are streamed [no limit]");
  addChoice<BlockTextureMode>(
      app, "--blocks", options.blocks,
      {{"auto", BlockTextureMode::automatic}, {"keep", BlockTextureMode::keep}, {"decode", BlockTextureMode::decode}},
      "Keep texture compression (bc1, bc7), or decode textures to rgba8 [auto: decode on software devices that have "
      "the memory]");
  addChoice<TextureFilter>(app, "--filter", options.filter,
                           {{"auto", TextureFilter::automatic},
                            {"bilinear", TextureFilter::bilinear},
                            {"trilinear", TextureFilter::trilinear},
                            {"bicubic", TextureFilter::bicubic}},
                           "Texture filter: one mip level (bilinear), two (trilinear), or two with sharper "
                           "magnification (bicubic) [auto: trilinear, bilinear on software devices]");
}

void declareTextureFormat(CLI::App& app, TextureFormat& format) {
  addChoice<TextureFormat>(
      app, "--texture", format,
      {{"rgba8", TextureFormat::rgba8}, {"bc1", TextureFormat::bc1}, {"bc7", TextureFormat::bc7}},
      "Texture compression: none with 4 bytes per pixel (rgba8), or blocks with 0.5 (bc1) or 1 byte per pixel (bc7) "
      "[rgba8]");
}

nlohmann::ordered_json optionsJson(const RenderSettings& settings) {
  return {{"composition", optionValue(settings.composition)},
          {"photographs", settings.gatherCandidates},
          {"colours", settings.gatherColours},
          {"layers", settings.gatherLayers},
          {"voteScale", settings.voteScale},
          {"cells", settings.maxCells},
          {"tiers", settings.maxTier},
          {"morph", settings.morph == Morph::ours ? "ours" : "paper"},
          {"align", settings.alignCells ? "on" : "off"},
          {"order", settings.order == DrawOrder::ours ? "ours" : "paper"},
          {"blend", optionValue(settings.blend)},
          {"extrapolation", settings.extrapolationLimit},
          {"switch", settings.switchSeconds},
          {"textureScale", settings.textureScale},
          {"renderScale", settings.renderScale},
          {"eyeColours", settings.shareEyeColours ? "shared" : "own"},
          {"exposure", optionValue(settings.exposure)},
          {"colour", optionValue(settings.colourMapping)},
          {"colourTable", settings.colourTable == ColourTable::naive    ? "naive"
                          : settings.colourTable == ColourTable::strict ? "strict"
                                                                        : "preserving"},
          {"colourSamples", settings.colourSamples},
          {"colourProxy", settings.colourProxy},
          {"colourPeriod", settings.colourPeriod}};
}

nlohmann::ordered_json settingsJson(const RenderSettings& settings, const GpuSceneOptions& gpuScene) {
  nlohmann::ordered_json json{{"preset", presetName(settings)}}, budget;  // null: no limit
  json.update(optionsJson(settings));
  if (gpuScene.budgetBytes > 0) budget = gpuScene.budgetBytes;
  json["vramBudget"] = budget;
  json["blocks"] = gpuScene.blocks == BlockTextureMode::keep     ? "keep"
                   : gpuScene.blocks == BlockTextureMode::decode ? "decode"
                                                                 : "auto";
  json["filter"] = gpuScene.filter == TextureFilter::bilinear    ? "bilinear"
                   : gpuScene.filter == TextureFilter::trilinear ? "trilinear"
                   : gpuScene.filter == TextureFilter::bicubic   ? "bicubic"
                                                                 : "auto";
  return json;
}

nlohmann::ordered_json pictureSettingsJson(const RenderSettings& settings, const GpuSceneOptions& gpuScene,
                                           const std::optional<FloorOptions>& floor) {
  nlohmann::ordered_json json = settingsJson(settings, gpuScene), eyeHeight, spacing, overlay;
  if (floor) eyeHeight = floor->eyeHeight;
  if (floor && floor->spacing) spacing = *floor->spacing;
  if (settings.overlay != Overlay::none) overlay = optionValue(settings.overlay).word;
  json["floor"] = eyeHeight;
  json["floorSpacing"] = spacing;
  json["overlay"] = overlay;
  json["mute"] = settings.mutedCells;
  json["solo"] = settings.soloCells;
  return json;
}

}  // namespace ibr::app
