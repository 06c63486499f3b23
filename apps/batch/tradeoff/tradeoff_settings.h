// SPDX-License-Identifier: Apache-2.0
// Which settings `ibr tradeoff` compares (NUMERICS §5.4): knobs one at a time, presets, and a few combinations.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "ibr/renderer.h"

namespace ibr::app {

/// All that makes a picture of a view.
struct TradeoffWay {
  RenderSettings settings;
  TextureFilter filter = TextureFilter::automatic;
  std::optional<TextureFormat> texture;  // nullopt: as the scene has them, and as is usual on the device
  std::size_t views = 1;                 // 2: the second eye beside the view
  std::size_t build = 0;                 // 0: the scene; others: further builds of it

  bool operator==(const TradeoffWay&) const = default;
};

/// What a way is called: "cells" "4", "preset" "fast", "grid" "cells 4 renderScale 0.7", "build" NAME.
struct TradeoffLabel {
  std::string knob, value;
  std::string text() const { return knob == "grid" ? value : knob + " " + value; }
};

struct TradeoffSetting {
  TradeoffWay way;
  std::vector<TradeoffLabel> labels;  // at least one; several where knobs meet, as in the default
  std::string name() const { return labels.front().text(); }
  /// Of this knob; nullptr where it has none.
  const std::string* valueOf(const std::string& knob) const;
};

/// A knob around `base`: an index into the settings.
struct TradeoffKnob {
  std::string name, about;
  std::size_t base;
};

struct TradeoffSettings {
  std::vector<TradeoffSetting> all;  // the first four are the presets, from the fastest; no way comes twice
  std::vector<TradeoffKnob> knobs;   // in the order of the report
};

inline constexpr std::size_t kDefaultSetting = 1, kReferenceSetting = 3;  // balanced, reference

/// Names of all knobs, without "preset", "grid" and "build".
std::vector<std::string> tradeoffKnobNames();

struct TradeoffWish {
  DeviceKind kind = DeviceKind::software;  // whose presets
  std::vector<std::string> knobs;          // of tradeoffKnobNames(); empty: all
  bool grid = true;                        // also combinations
  bool textures = true;                    // textures can be had in other formats
  std::vector<std::string> builds;         // names of further builds of the place
};
TradeoffSettings tradeoffSettings(const TradeoffWish& wish);

/// Each setting under the name of its option, with "texture" (null: as stored), "views" and "build".
nlohmann::ordered_json wayJson(const TradeoffWay& way);

}  // namespace ibr::app
