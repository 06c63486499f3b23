// SPDX-License-Identifier: Apache-2.0
#include "shared/cli/setting_arguments.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "shared/cli/htm_view_settings.h"
#include "shared/cli/options.h"
#include "shared/cli/presets.h"
#include "shared/cli/settings.h"
#include "support/json.h"

using namespace ibr;
using namespace ibr::app;
using Json = nlohmann::ordered_json;

namespace {

// Parses words in reverse, the order that CLI11 expects.
void parse(CLI::App& app, std::vector<std::string> words) {
  std::ranges::reverse(words);
  app.parse(words);
}

}  // namespace

TEST_CASE("settings become options with exact values, and null or false settings are left out") {
  const Json settings{{"cells", 3},       {"renderScale", 1.0 / 3}, {"stereo", true},        {"graph", false},
                      {"floor", nullptr}, {"blend", "mixed"},       {"mute", Json::array()}, {"solo", {7, 5}}};
  CHECK(settingArguments(settings) == std::vector<std::string>{"--cells", "3", "--render-scale", "0.3333333333333333",
                                                               "--stereo", "--blend", "mixed", "--solo", "7,5"});
}

TEST_CASE("a scene's settings round trip through their options") {
  GpuSceneOptions gpuScene;
  gpuScene.budgetBytes = 123456789;
  gpuScene.blocks = BlockTextureMode::decode;
  gpuScene.filter = TextureFilter::bicubic;
  RenderSettings settings = preset(Preset::reference, DeviceKind::software);
  settings.maxTier = kTierConsistent;
  settings.morph = Morph::paper;
  settings.alignCells = true;
  settings.composition = Composition::hybrid;
  settings.gatherCandidates = 7;
  settings.gatherColours = 3;
  settings.gatherLayers = 1;
  settings.voteScale = 1.0 / 3;
  settings.order = DrawOrder::paper;
  settings.blend = BlendMode::mixed;
  settings.maxCells = 3;
  settings.extrapolationLimit = 1.0 / 7;
  settings.switchSeconds = 0.1;
  settings.textureScale = 1e-2;
  settings.renderScale = 2.0 / 3;
  settings.exposure = Exposure::scene;
  settings.colourMapping = ColourMapping::paperRedraw;
  settings.colourTable = ColourTable::strict;
  settings.colourSamples = 1e-5;
  settings.colourProxy = 3;
  settings.colourPeriod = 5;
  settings.shareEyeColours = false;

  RenderSettings again;
  GpuSceneOptions gpuSceneAgain;
  CLI::App app;
  declareAllSettings(app, again);
  declareGpuScene(app, gpuSceneAgain);
  parse(app, settingArguments(settingsJson(settings, gpuScene)));
  CHECK(settingsJson(again, gpuSceneAgain) == settingsJson(settings, gpuScene));
  CHECK(again.switchSeconds == settings.switchSeconds);
  CHECK(again.colourPeriod == settings.colourPeriod);
  CHECK(again.colourMapping == settings.colourMapping);
  CHECK(gpuSceneAgain.budgetBytes == gpuScene.budgetBytes);
  // Every setting is written, so that none depends on a default.
  const Json plain = settingsJson({}, {}), other = settingsJson(settings, gpuScene);
  for (const auto& [key, value] : other.items()) {
    INFO(key);
    CHECK(value != plain.at(key));
  }
}

TEST_CASE("settings start from the preset balanced or from a command's defaults, and options override them") {
  const DeviceKind here = deviceKindFor("");
  RenderSettings settings = preset(Preset::reference, here);
  CLI::App plain;
  declareAllSettings(plain, settings);
  declareOverlays(plain, settings);
  parse(plain, {});
  CHECK((settings == preset(Preset::balanced, here)));
  CHECK(givenArguments(plain).empty());
  parse(plain, {"--tiers", "2", "--preset", "accurate"});
  CHECK(settings.maxTier == kTierCompleted);
  CHECK(settings.maxCells == preset(Preset::accurate, here).maxCells);
  CHECK(givenArguments(plain) == std::vector<std::string>{"--preset", "accurate", "--tiers", "2"});
  // A preset with a device kind is accepted on every device.
  for (const auto& [word, kind] : {std::pair{"-software", DeviceKind::software}, {"-hardware", DeviceKind::hardware}})
    for (const auto& [name, chosen] : kPresets) {
      parse(plain, {"--preset", std::string(name) + word});
      CHECK((settings == preset(chosen, kind)));
      const bool isSame = chosen == Preset::fast || chosen == Preset::reference;  // equal on all devices
      CHECK(presetName(chosen, kind) == name + std::string(isSame ? "" : word));
      // `ibr render` must accept the words of every preset.
      RenderSettings again;
      CLI::App product;
      declareSettings(product, again);
      parse(product, settingArguments(optionsJson(preset(chosen, kind))));
      CHECK((again == preset(chosen, kind)));
    }
  for (const char* none : {"best", "fast-", "-software", "balanced-gpu"})
    CHECK_THROWS_AS(parse(plain, {"--preset", none}), CLI::ValidationError);

  // Options of cells select the composition `cells`, unless a composition is given.
  using Words = std::vector<std::string>;
  for (const Words& words : {Words{"--order", "paper"},
                             {"--colour", "paper-redraw"},
                             {"--solo", "3"},
                             {"--preset", "accurate-hardware", "--colour", "paper"}}) {
    parse(plain, words);
    CHECK(settings.composition == Composition::cells);
  }
  parse(plain, {"--composition", "hybrid", "--solo", "3"});
  CHECK(settings.composition == Composition::hybrid);
  parse(plain, {"--preset", "balanced-hardware", "--order", "ours"});
  CHECK(settings.composition == Composition::hybrid);

  RenderSettings defaults;
  defaults.maxCells = 3;
  CLI::App own;
  declareSettings(own, settings, defaults);
  parse(own, {});
  CHECK((settings == defaults));
}

TEST_CASE("settings are described by the nearest preset and the differing options") {
  for (const DeviceKind kind : {DeviceKind::software, DeviceKind::hardware})
    for (const auto& [word, chosen] : kPresets) {
      RenderSettings settings = preset(chosen, kind);
      const std::string name = presetName(chosen, kind);
      CHECK(presetName(settings) == name);
      CHECK(presetText(settings) == name);
      CHECK(settingsJson(settings, {}).at("preset") == name);
      settings.textureScale = 0.5;
      settings.blend = BlendMode::dither;
      CHECK(presetName(settings) == name);
      CHECK_THAT(presetText(settings),
                 Catch::StartsWith(name) && Catch::EndsWith("--blend dither --texture-scale 0.5"));
    }
}

TEST_CASE("overlays and muted or soloed cells round trip through their options") {
  for (const OverlayOption& line : kOverlays) {
    RenderSettings settings;
    settings.overlay = line.overlay;
    if (line.overlay == Overlay::depth) settings.mutedCells = {7, 0, 4294};
    if (line.overlay == Overlay::tiers) settings.soloCells = {3};
    RenderSettings again;
    CLI::App app;
    declareAllSettings(app, again);
    GpuSceneOptions gpuScene;
    declareGpuScene(app, gpuScene);
    declareOverlays(app, again);
    Json words = pictureSettingsJson(settings, {}, std::nullopt);
    parse(app, settingArguments(words));
    CHECK(pictureSettingsJson(again, gpuScene, std::nullopt) == words);
    CHECK(again.overlay == settings.overlay);
    CHECK(again.mutedCells == settings.mutedCells);
    CHECK(again.soloCells == settings.soloCells);
  }
}

TEST_CASE("a harmonised model's settings round trip through their options") {
  HtmSettings settings;
  settings.method = HtmMethod::vertexColours;
  settings.gamma = 100.0 / 3;
  settings.weightCut = 1.0 / 77;
  settings.smoothingSeconds = 0.3;
  HtmSettings again;
  bool sourceMesh = false;
  CLI::App app;
  declareHtmPictureSettings(app, again, sourceMesh);
  parse(app, settingArguments(htmSettingsJson(settings, true)));
  CHECK(htmSettingsJson(again, sourceMesh) == htmSettingsJson(settings, true));
  CHECK(sourceMesh);
  CHECK(again.weightCut == settings.weightCut);
}
