// SPDX-License-Identifier: Apache-2.0
#include "batch/settings.h"

#include <fmt/format.h>

#include "batch/options.h"

namespace ibr::app {

void declarePictureSettings(CLI::App& app, RenderSettings& settings) {
  addInt(app, "--tiers", settings.lowestTier, kTierAgrees, kTierFilled,
         "Draw tiers 0 to N: 0 agrees in all photographs, 1 was rejected by a filter, 2 is a photograph's backdrop, 3 "
         "fills what is still empty from around");
  addChoice<Morph>(app, "--morph", settings.morph, {{"ours", Morph::ours}, {"paper", Morph::paper}},
                   "Where vertices are seen: by inverse distances, or by the paper's equation 4 [ours]");
  addChoice<BlendMode>(app, "--blend", settings.blend,
                       {{"blend", BlendMode::blend}, {"dither", BlendMode::dither}, {"mixed", BlendMode::mixed}},
                       "Weighted sum of the photographs, one of them a pixel, or the mean of both [blend]");
  addDouble(app, "--extrapolation", settings.extrapolationLimit, 0, 1e6,
            "Draw no cell that is further away than X times its size");
  addChoice<ColourTable>(
      app, "--colour-table", settings.colourTable,
      {{"naive", ColourTable::naive}, {"strict", ColourTable::strict}, {"preserving", ColourTable::preserving}},
      "How colour tables go on beyond the colours that cells share [preserving]");
  addDouble(app, "--colour-samples", settings.colourSamples, 0, 1,
            "Share of the pixels of an overlap that colour tables are made from");
  addInt(app, "--colour-proxy", settings.colourProxy, 1, 64,
         "Colour tables of ours are made from a picture of all cells whose sides are N times shorter");
}

void declareSettings(CLI::App& app, RenderSettings& settings) {
  declarePictureSettings(app, settings);
  app.add_option_function<std::string>(
         "--cells",
         [&settings](const std::string& text) {
           settings.maxCells = std::uint32_t(parsedInt("--cells", text, 1, kLargestCellCount));
         },
         fmt::format("Draw at most N cells [{}]", settings.maxCells))
      ->type_name("N");
  addChoice<DrawOrder>(app, "--order", settings.order, {{"ours", DrawOrder::ours}, {"paper", DrawOrder::paper}},
                       "Main cell first with depth, or the paper's back to front without [ours]");
  addChoice<ColourMapping>(
      app, "--colour", settings.colourMapping,
      [] {
        std::vector<std::pair<std::string, ColourMapping>> choices;
        for (const auto& [word, mapping] : kColourMappings) choices.emplace_back(word, mapping);
        return choices;
      }(),
      "Colours of all cells adapt to the main cell's: tables from a proxy, or the paper's sequence, whose tables are\n"
      "applied to all pixels or by drawing again [off]");
}

ColourSupport colourSupport(const RenderSettings& settings) {
  switch (settings.colourMapping) {
    case ColourMapping::off:
      return ColourSupport::off;
    case ColourMapping::ours:
      return ColourSupport::ours;
    case ColourMapping::paper:
    case ColourMapping::paperRedraw:
      break;
  }
  return ColourSupport::all;
}

const char* wordOf(ColourMapping mapping) {
  for (const auto& [word, meaning] : kColourMappings)
    if (meaning == mapping) return word;
  return "";
}

const char* wordOf(BlendMode blend) {
  return blend == BlendMode::blend ? "blend" : blend == BlendMode::dither ? "dither" : "mixed";
}

nlohmann::ordered_json settingsJson(const RenderSettings& settings) {
  return {{"cells", settings.maxCells},
          {"tiers", settings.lowestTier},
          {"morph", settings.morph == Morph::ours ? "ours" : "paper"},
          {"order", settings.order == DrawOrder::ours ? "ours" : "paper"},
          {"blend", wordOf(settings.blend)},
          {"extrapolation", settings.extrapolationLimit},
          {"colour", wordOf(settings.colourMapping)},
          {"colourTable", settings.colourTable == ColourTable::naive    ? "naive"
                          : settings.colourTable == ColourTable::strict ? "strict"
                                                                        : "preserving"},
          {"colourSamples", settings.colourSamples},
          {"colourProxy", settings.colourProxy}};
}

}  // namespace ibr::app
