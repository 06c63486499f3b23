// SPDX-License-Identifier: Apache-2.0
// Settings that `ibr tradeoff` compares: presets, knobs varied one at a time, and a few combinations.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "ibr/renderer.h"

namespace ibr::app {

/// All inputs of a view's image.
struct TradeoffVariant {
  RenderSettings settings;
  TextureFilter filter = TextureFilter::automatic;
  std::optional<TextureFormat> texture;  // nullopt: as stored in the scene, converted as usual for the device
  std::size_t views = 1;                 // 2: with a second eye beside the view
  std::size_t build = 0;                 // 0: the scene; others: further builds of the scene

  bool operator==(const TradeoffVariant&) const = default;
};

/// Name of a variant: "cells" "4", "preset" "fast", "grid" "cells 4 reach 2 scale 0.7", "build" NAME.
struct TradeoffLabel {
  std::string knob, value;
  std::string text() const { return knob == "grid" ? value : knob + " " + value; }
};

struct TradeoffSetting {
  TradeoffVariant variant;
  std::vector<TradeoffLabel> labels;  // at least one; several if knobs share this setting, as the default does
  std::string name() const { return labels.front().text(); }
  /// Returns the setting's value of a knob; nullptr if it has none.
  const std::string* valueOf(const std::string& knob) const;
};

/// A knob varied around `base`, an index into the settings.
struct TradeoffKnob {
  std::string name, about;
  std::size_t base;
};

struct TradeoffSettings {
  std::vector<TradeoffSetting> all;  // the first four are the presets, from the fastest; variants are unique
  std::vector<TradeoffKnob> knobs;   // in the order of the report
};

inline constexpr std::size_t kDefaultSetting = 1, kReferenceSetting = 3;  // balanced, reference

/// Returns the names of all knobs, without "preset", "grid" and "build".
std::vector<std::string> tradeoffKnobNames();

struct TradeoffSelection {
  DeviceKind kind = DeviceKind::software;  // kind of the presets
  std::vector<std::string> knobs;          // from tradeoffKnobNames(); empty: all
  bool grid = true;                        // true: also combinations
  bool textures = true;                    // true: the scene's textures can be converted to other formats
  std::vector<std::string> builds;         // names of further builds of the scene
};
TradeoffSettings tradeoffSettings(const TradeoffSelection& selection);

/// Returns each setting under the name of its option, with "texture" (null: as stored), "views" and "build".
nlohmann::ordered_json variantJson(const TradeoffVariant& variant);

}  // namespace ibr::app
