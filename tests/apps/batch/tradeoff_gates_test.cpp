// SPDX-License-Identifier: Apache-2.0
// Settings of `ibr tradeoff` and its gates, on handmade figures.
#include <algorithm>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "batch/tradeoff/tradeoff_gates.h"
#include "batch/tradeoff/tradeoff_histogram.h"
#include "shared/cli/presets.h"
#include "shared/cli/settings.h"
#include "support/json.h"

using namespace ibr;
using namespace ibr::app;

namespace {

TradeoffRow rowOf(const std::string& name, double milliseconds, double flip, std::uint64_t draws = 10) {
  TradeoffRow row;
  row.setting = {{}, {{"grid", name}}};
  TradeoffView view;
  view.truth.flip = flip;
  view.truth.psnr = 30 - 100 * flip;
  view.draws = draws;
  view.triangles = 1000;
  row.views = {view};
  row.deviceMs = {{milliseconds}, {milliseconds}, {milliseconds}};
  row.planMs = {{0}, {0}, {0}};
  return row;
}

// Presets in the correct order: each is more expensive and more accurate than the previous one.
std::vector<TradeoffRow> presets() {
  return {rowOf("fast", 10, 0.10, 4), rowOf("balanced", 20, 0.08, 8), rowOf("accurate", 30, 0.07, 12),
          rowOf("reference", 60, 0.0695, 40)};
}

// The first gate whose name has all these words.
const TradeoffGate& gateOf(const std::vector<TradeoffGate>& gates, const std::vector<std::string>& words) {
  const auto found = std::ranges::find_if(gates, [&](const TradeoffGate& gate) {
    return std::ranges::all_of(words,
                               [&](const std::string& word) { return gate.name.find(word) != std::string::npos; });
  });
  REQUIRE(found != gates.end());
  return *found;
}

}  // namespace

TEST_CASE("preset gates hold if each preset is slower and more accurate than the previous one", "[P11]") {
  for (const TradeoffGate& gate : presetGates(presets())) {
    INFO(gate.name << ": " << gate.found);
    CHECK(gate.holds);
  }
}

TEST_CASE("a preset is beaten only by settings that are more than 3 % better in both axes", "[P11]") {
  const auto holds = [](const TradeoffRow& other) {
    std::vector<TradeoffRow> rows = presets();
    rows.push_back(other);
    const auto gates = presetGates(rows);
    return std::pair(gateOf(gates, {"balanced", "time and error"}).holds,
                     gateOf(gates, {"balanced", "counts and error"}).holds);
  };
  CHECK((holds(rowOf("both", 19, 0.077, 7)) == std::pair(false, false)));
  CHECK((holds(rowOf("time alone", 10, 0.0777, 4)) == std::pair(true, true)));
  CHECK((holds(rowOf("error alone", 19.5, 0.05, 8)) == std::pair(true, true)));
  CHECK((holds(rowOf("fewer draws, slower", 25, 0.077, 7)) == std::pair(true, false)));
  CHECK((holds(rowOf("faster, more draws", 19, 0.077, 9)) == std::pair(false, true)));
  TradeoffRow larger = rowOf("more pixels", 25, 0.077, 7);
  larger.setting.variant.settings.renderScale = 1.5;
  CHECK((holds(larger) == std::pair(true, true)));
  TradeoffRow eyes = rowOf("two eyes", 19, 0.077, 7), built = eyes, failed = eyes;
  eyes.setting.variant.views = 2;
  built.setting.variant.build = 1;
  failed.failure = "no memory";
  for (const TradeoffRow& other : {eyes, built, failed}) CHECK((holds(other) == std::pair(true, true)));
}

TEST_CASE("preset gates check rising time, falling error and the PSNR of accurate", "[P11]") {
  std::vector<TradeoffRow> rows = presets();
  std::swap(rows[0], rows[1]);
  auto gates = presetGates(rows);
  CHECK_FALSE(gateOf(gates, {"time rises"}).holds);
  CHECK_FALSE(gateOf(gates, {"error falls"}).holds);
  rows = presets();
  rows[2] = rowOf("accurate", 30, 0.075, 12);  // 22.5 dB against 23.05 dB
  gates = presetGates(rows);
  CHECK_FALSE(gateOf(gates, {"accurate", "99 %", "PSNR"}).holds);
  CHECK(gateOf(gates, {"error falls"}).holds);
  CHECK_FALSE(gateOf(gates, {"time rises"}).counted);
}

TEST_CASE("fast has at most 1.25 times the error of balanced, and presets of equal cost may take any time", "[P11]") {
  const auto fast = [](double flip) {
    std::vector<TradeoffRow> rows = presets();
    rows[0] = rowOf("fast", 10, flip, 4);
    return gateOf(presetGates(rows), {"fast", "1.25"}).holds;
  };
  CHECK(fast(0.0999));
  CHECK_FALSE(fast(0.1001));
  const auto rise = [](std::uint64_t draws) {
    std::vector<TradeoffRow> rows = presets();
    rows[2] = rowOf("accurate", 15, 0.07, draws);
    return gateOf(presetGates(rows), {"time rises"}).holds;
  };
  CHECK(rise(8));  // as many as preset balanced
  CHECK_FALSE(rise(9));
}

TEST_CASE("the front of time and error leaves out beaten settings") {
  std::vector<TradeoffRow> rows = presets();
  rows.push_back(rowOf("between", 15, 0.09));
  rows.push_back(rowOf("behind", 16, 0.095));
  CHECK(timeFront(rows) == std::vector<std::size_t>{0, 4, 1, 2, 3});
}

TEST_CASE("tradeoff settings start with the presets, are unique, and vary one knob at a time") {
  const TradeoffSettings settings = tradeoffSettings({});
  for (std::size_t p = 0; p < kPresets.size(); ++p) {
    CHECK(settings.all[p].name() == std::string("preset ") + kPresets[p].first);
    CHECK((settings.all[p].variant.settings == preset(kPresets[p].second, DeviceKind::software)));
  }
  CHECK(settings.knobs.size() == tradeoffKnobNames().size());
  for (std::size_t i = 0; i < settings.all.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) CHECK_FALSE((settings.all[i].variant == settings.all[j].variant));
  for (const TradeoffKnob& knob : settings.knobs) {
    INFO(knob.name);
    const nlohmann::ordered_json base = variantJson(settings.all[knob.base].variant);
    std::size_t values = 0;
    for (const TradeoffSetting& setting : settings.all) {
      if (!setting.valueOf(knob.name)) continue;
      ++values;
      std::size_t differences = 0;
      const nlohmann::ordered_json variant = variantJson(setting.variant);
      for (const auto& [name, value] : variant.items()) differences += value != base[name];
      CHECK(differences <= 1);
    }
    CHECK(values >= 2);
  }
  CHECK(*settings.all[kDefaultSetting].valueOf("composition") == "hybrid");
  CHECK(*settings.all[kDefaultSetting].valueOf("tiers") == "3");

  const TradeoffSettings few = tradeoffSettings({.knobs = {"blend"}, .grid = false, .builds = {"coarse"}});
  CHECK(few.all.size() == 4 + 3 + 1);
  CHECK(few.all.back().name() == "build coarse");
  CHECK(few.all.back().variant.build == 1);
}

TEST_CASE("cached figures of images survive a round trip through JSON") {
  TradeoffRow row = rowOf("a", 10, 0.1), back = row;
  row.views[0].name = "view";
  row.views[0].prediction = "abc";
  row.measured = {1, 2, 3};
  row.workingBytes = 77;
  readPicture(test::parseOrderedJson(test::jsonLine(pictureJson(row))), back);
  CHECK(test::jsonLine(pictureJson(back)) == test::jsonLine(pictureJson(row)));  // NaN becomes null
  CHECK(back.deviceMs.empty());
  CHECK_THROWS_AS(readPicture({{"views", 1}}, back), nlohmann::json::exception);
}

TEST_CASE("errors of colour tables fall with more pixels, and are smaller for the same pixels") {
  Image8 photograph(256, 128, 3);
  for (std::size_t i = 0; i < photograph.values.size(); ++i)
    photograph.values[i] = std::uint8_t(40 + (i / 3 * 7919) % 160);
  const std::vector<MapError> errors = mapErrors(photograph, 1);
  REQUIRE(errors.size() == 8);
  CHECK(errors.front().samples == 10);
  CHECK(errors.back().samples == 30000);
  CHECK(errors.front().apart > 10 * errors.back().apart);
  CHECK(errors.back().same < 0.1);
  for (const MapError& error : errors) CHECK(error.same < error.apart);
}
