// SPDX-License-Identifier: Apache-2.0
// The viewer's panels, driven by keys and the mouse.
#include "support/json.h"
#include "viewer_harness.h"

#include <nlohmann/json.hpp>

namespace fs = std::filesystem;
using namespace ibr;
using namespace ibr::test;
using Catch::Contains;
using nlohmann::json;

TEST_CASE("the keyboard alone moves the view and changes a setting in the panel") {
  if (!canView()) return;
  const auto begin = parseJson(view({tinyScene(), "--size", "640x480", "--frames", "2"}).out)["documents"][0];
  const auto looked =
      whileViewing({tinyScene(), "--size", "640x480"}, [](const std::string&) { hold("Right", 0.3); })["documents"][0];
  CHECK(looked["position"] == begin["position"]);
  const glm::dvec3 right = rotationOf(begin) * glm::dvec3(1, 0, 0);
  CHECK(glm::dot(rotationOf(looked) * glm::dvec3(0, 0, -1), right) > 0.02);

  const auto chosen = whileViewing({tinyScene(), "--size", "640x480"}, [](const std::string&) {
    pressAll({"2", "F6", "Down", "Down", "Down", "Down", "space", "Down"});  // the document, two rows of tabs, presets
    for (const char* key : {"w", "k", "bracketright", "l"}) hold(key, 0.2);  // keys that the focused panel ignores
  })["documents"][0];
  CHECK(chosen["settings"] != begin["settings"]);
  CHECK(positionOf(chosen) == positionOf(begin));
  CHECK(rotationOf(chosen) == rotationOf(begin));

  const auto back = whileViewing({tinyScene(), "--size", "640x480"}, [](const std::string&) {
    pressAll({"F6", "Down", "F6"});
    hold("w", 0.4);
    hold("Right", 0.3);
  })["documents"][0];
  CHECK(back["settings"] == begin["settings"]);
  CHECK(positionOf(back) != positionOf(begin));
  CHECK(rotationOf(back) != rotationOf(begin));
}

TEST_CASE("a preset chosen after a smaller render scale is drawn at its own scale") {
  if (!canView()) return;
  const auto chosen = [](const std::vector<std::string>& options) {
    std::vector<std::string> arguments{tinyScene(), "--size", "640x480", "--preset", "fast"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    Image8 pixels;
    const json report = whileViewing(arguments, [&](const std::string& window) {
      pressAll({"2", "F6", "Down", "Down", "Down", "Down", "space", "Down"});  // the first preset: fast
      pixels = settledPixels(window);
    });
    return std::pair{report["documents"][0]["settings"], pixels};
  };
  const auto [settings, pixels] = chosen({});
  const auto [settingsAfter, pixelsAfter] = chosen({"--render-scale", "0.5"});
  REQUIRE(settings["renderScale"] == 1);
  CHECK(settingsAfter == settings);
  CHECK(sameBesidePanel(pixelsAfter, pixels));
}

TEST_CASE("values typed into a slider are clamped, and the scene stays open") {
  if (!canView()) return;
  const json report = whileViewing({tinyScene(), "--size", "500x400"}, [](const std::string& w) {
    for (const char* page : {"1", "2"}) {
      pressAll({page});
      // Positions of sliders on either tab.
      for (const int y : {154, 177, 223, 310, 333}) {
        act({"mousemove", "--window", w, "270", std::to_string(y)});
        act({"keydown", "ctrl", "click", "1", "keyup", "ctrl"});
        act({"type", "--", "-3000"});
        pressAll({"Return"});
      }
    }
  });
  REQUIRE(report["documents"].size() == 1);
  CHECK(report["warnings"].empty());
  CHECK(report["documents"][0]["fovY"] == Approx(glm::radians(10.0)));  // the minimum
  CHECK(report["documents"][0]["settings"]["extrapolation"] >= 0);
}

TEST_CASE("presets are measured at the current view") {
  if (!canView()) return;
  const json place = whileViewing({tinyScene(), "--size", "500x400", "--preset", "accurate", "--texture-scale", "0.1"},
                                  [](const std::string& w) {
                                    pressAll({"2"});
                                    // Approximate positions of the buttons of the last preset and of the measurement.
                                    for (int y = 224; y > 195; y -= 6)
                                      act({"mousemove", "--window", w, "280", std::to_string(y), "click", "1"});
                                    settledPixels(w);
                                  })["documents"][0];
  const json& effects = place["effects"];
  INFO(jsonLine(effects));
  for (const char* name : {"fast", "balanced", "accurate", "reference", "as set"}) {
    REQUIRE(effects.contains(name));
    CHECK(effects[name]["ms"] > 0);
  }
  CHECK(effects["reference"]["psnr"].is_null());
  // Textures at a tenth of their detail. All presets show this small scene completely.
  CHECK(effects["as set"]["psnr"] > 10);
  CHECK(effects["as set"]["psnr"] < 60);
  CHECK(effects["accurate"]["psnr"].is_null());
}

TEST_CASE("cells are muted and soloed by keys in the list of cells") {
  if (!canView()) return;
  TemporaryFolder folder;
  const auto after = [&](const char* shot, std::vector<std::string> keys) {
    keys.insert(keys.begin(), {"3", "F6", "Down", "Down", "Down", "Down", "space",
                               "Down"});  // the document, two rows of tabs, into the list, the cell
    Image8 pixels;
    const json report =
        whileViewing({tinyScene(), "--composition", "cells", "--size", "640x480", "--screenshot", folder / shot},
                     [&](const std::string& window) {
                       pressAll(keys);
                       pixels = settledPixels(window);
                     });
    CHECK(sameBesidePanel(pixels, readImage(folder / shot)));
    return report["documents"][0]["settings"];
  };
  const json none = json::array();
  const json muted = after("muted.png", {"space"}), solo = after("solo.png", {"Right", "space"});
  REQUIRE(muted["mute"].size() == 1);
  CHECK(muted["solo"] == none);
  CHECK(solo["solo"] == muted["mute"]);  // in one row
  CHECK(solo["mute"] == none);
  CHECK((readImage(folder / "muted.png").values != readImage(folder / "solo.png").values));
  const json back = after("back.png", {"space", "space"});  // the cell keeps the keyboard focus, wherever its row moves
  CHECK(back["mute"] == none);
  const json all = after("all.png", {"Right", "space", "Escape", "Up", "space"});
  CHECK(all["solo"] == none);
}

TEST_CASE("O cycles through the overlays, and ibr render reproduces screenshots with overlays") {
  if (!canView()) return;
  TemporaryFolder folder;
  whileViewing({tinyScene(), "--size", "320x240", "--screenshots", folder.path(), "--mute", "99"},
               [](const std::string&) {
                 const auto shoot = [](const std::vector<std::string>& keys) {
                   pressAll(keys);
                   sleepFor(1);
                 };
                 shoot({"o", "o", "p"});
                 shoot({"shift+o", "shift+o", "shift+o", "p"});
                 shoot({"o", "p"});
               });
  const std::array<std::string, 3> overlays{"tiers", "agreement", "none"};
  for (std::size_t i = 0; i < overlays.size(); ++i) {
    INFO(overlays[i]);
    const fs::path shot = folder / ("view_000" + std::to_string(i + 1) + ".png");
    REQUIRE(fs::exists(shot));
    const auto shotInfo = runProgram({"info", shot, "--json", "-"});
    const json settings = parseJson(shotInfo.out)["settings"];
    CHECK(settings["overlay"] == (overlays[i] == "none" ? json() : json(overlays[i])));
    CHECK(settings["mute"].empty());
    const auto drawn = runProgram(
        {"render", tinyScene(), "--poses", shot, "-o", folder / overlays[i], "--overlay", overlays[i], "--json", "-"});
    INFO(drawn.err);
    REQUIRE(drawn.code == 0);
    const fs::path again = parseJson(drawn.out)["views"][0]["file"].get<std::string>();
    CHECK((readImage(again).values == readImage(shot).values));
  }
  CHECK((readImage(folder / "view_0001.png").values != readImage(folder / "view_0003.png").values));
  CHECK((readImage(folder / "view_0002.png").values != readImage(folder / "view_0003.png").values));
}
