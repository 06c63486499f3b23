// SPDX-License-Identifier: Apache-2.0
// The viewer's window: size, formats, recovery of lost objects, interface scale.
#include "viewer_harness.h"

#include <nlohmann/json.hpp>

namespace fs = std::filesystem;
using namespace ibr;
using namespace ibr::test;
using Catch::Contains;
using nlohmann::json;

TEST_CASE("the window continues after repeated resizing and minimising") {
  if (!canView()) return;
  TemporaryFolder folder;
  Image8 pixels;
  const json report =
      whileViewing({tinyScene(), "--size", "400x300", "--no-interface", "--screenshot", folder / "shot.png"},
                   [&](const std::string& w) {
                     for (int i = 0; i < 15; ++i, sleepFor(0.03))
                       xdotool({"windowsize", w, std::to_string(300 + 31 * i), std::to_string(500 - 23 * i)});
                     sleepFor(0.3);
                     xdotool({"windowminimize", w});
                     sleepFor(0.5);
                     xdotool({"windowactivate", "--sync", w});
                     xdotool({"windowsize", "--sync", w, "360", "280"});
                     pixels = settledPixels(w);
                   });
  CHECK(report["size"] == json::array({360, 280}));
  CHECK(report["warnings"].empty());
  CHECK((pixels.values == readImage(folder / "shot.png").values));
}

TEST_CASE("the window shows the exact values of the image in any surface format") {
  if (!canView()) return;
  TemporaryFolder folder;
  const auto seen = [&](const char* name, std::vector<std::string> more) {
    std::vector<std::string> arguments{tinyScene(), "--size", "320x240", "--screenshot", folder / name};
    arguments.insert(arguments.end(), more.begin(), more.end());
    Image8 pixels;
    whileViewing(arguments, [&](const std::string& window) { pixels = settledPixels(window); });
    return pixels;
  };
  const Image8 bare = seen("bare.png", {"--no-interface"});
  const Image8 srgb = seen("srgb.png", {"--no-interface", "--only-srgb"});
  CHECK((bare.values == readImage(folder / "bare.png").values));
  CHECK((srgb.values == bare.values));
  CHECK((readFile(folder / "srgb.png") == readFile(folder / "bare.png")));
  // The interface is equal, too: with nothing moving, the panel's texts lie over the image.
  const Image8 with = seen("with.png", {}), withSrgb = seen("with_srgb.png", {"--only-srgb"});
  CHECK((with.values == withSrgb.values));
  CHECK((with.values != readImage(folder / "with.png").values));
}

TEST_CASE("a lost surface is created again") {
  if (!canView()) return;
  Image8 pixels;
  TemporaryFolder folder;
  whileViewing(
      {tinyScene(), "--size", "320x240", "--no-interface", "--lose-surface", "3", "--screenshot", folder / "shot.png"},
      [&](const std::string& window) {
        pressAll({"bracketright"});  // frames continue
        sleepFor(1);
        pixels = settledPixels(window);
      });
  CHECK((pixels.values == readImage(folder / "shot.png").values));
}

TEST_CASE("after a lost device the viewer continues with the same image") {
  if (!canView()) return;
  TemporaryFolder folder;
  const auto shown = [&](const char* name, std::vector<std::string> more) {
    std::vector<std::string> arguments{tinyScene(), "--size",       "320x240",    "--frames",
                                       "5",         "--screenshot", folder / name};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return view(arguments);
  };
  REQUIRE(shown("kept.png", {}).code == 0);
  const auto outcome = shown("lost.png", {"--lose-device", "3"});
  CHECK(outcome.code == 0);
  CHECK_THAT(outcome.err, Contains("--lose-device"));
  CHECK((readFile(folder / "lost.png") == readFile(folder / "kept.png")));
}

TEST_CASE("the interface's scale follows the monitor, an option and keys, and the mouse hits the panels") {
  if (!canView()) return;
  TemporaryFolder folder;
  // Extent of the side panel: columns and rows in which the window differs from the image without the panel.
  struct Seen {
    int left = 10000, bottom = 0;
  };
  const auto seen = [&](std::vector<std::string> more, const std::function<void(const std::string&)>& act = {}) {
    std::vector<std::string> arguments{tinyScene(), "--size", "900x700", "--screenshot", folder / "bare.png"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    Image8 pixels;
    whileViewing(arguments, [&](const std::string& window) {
      if (act) act(window);
      sleepFor(0.3);
      pixels = settledPixels(window);
    });
    const Image8 bare = readImage(folder / "bare.png");
    Seen panel;
    for (int y = 0; y < bare.height; ++y)
      for (int x = 0; x < bare.width; ++x)
        if (!std::ranges::equal(bare.pixel(x, y), pixels.pixel(x, y)))
          panel = {std::min(panel.left, x), std::max(panel.bottom, y)};
    return panel;
  };
  const auto looksFrom = [&](int x) {
    const auto place =
        whileViewing({tinyScene(), "--size", "900x700", "--interface-scale", "1.25"}, [&](const std::string& window) {
          act({"mousemove", "--window", window, std::to_string(x), "200"});
          act({"mousedown", "3"});
          for (int i = 0; i < 4; ++i) act({"mousemove_relative", "0", "9"});
          act({"mouseup", "3"});
        })["documents"][0];
    return place["rotation"];
  };
  const Seen one = seen({}), larger = seen({"--interface-scale", "1.25"});
  const int wide = 900 - 10;  // right edge of the panel
  CHECK(wide - one.left == Approx(26 * 13).margin(2));
  CHECK(wide - larger.left == Approx(26 * 16).margin(2));
  CHECK(looksFrom(larger.left - 10) != looksFrom(larger.left + 10));
  {
    const MonitorDpi monitor(120);
    CHECK(seen({}).left == larger.left);
  }
  const Seen keyed = seen({}, [](const std::string&) { pressAll({"ctrl+equal"}); });
  CHECK(keyed.left == larger.left);
  CHECK(keyed.bottom == larger.bottom);
  const Seen same = seen({}, [](const std::string&) { pressAll({"ctrl+equal", "ctrl+minus"}); });
  CHECK(same.left == one.left);
  CHECK(same.bottom == one.bottom);
}

TEST_CASE("an edited shader is reloaded, and a broken one shows the compiler's message") {
  if (!canView()) return;
  TemporaryFolder folder;
  fs::copy(IBR_SHADERS, folder / "shaders", fs::copy_options::recursive);
  const fs::path file = folder / "shaders/render/composite.frag";
  const std::string original = readTextFile(file);
  const std::size_t end = original.rfind('}');
  REQUIRE(end != std::string::npos);
  std::vector<std::vector<std::uint8_t>> shown;  // in the window
  const auto report = whileViewing(
      {tinyScene(), "--size", "320x240", "--no-interface", "--screenshots", folder.path(), "--shaders",
       folder / "shaders"},
      [&](const std::string& window) {
        const auto shoot = [&] {
          shown.push_back(settledPixels(window).values);
          xdotool({"key", "p"});
          sleepFor(1.2);
        };
        // Shaders compile in the background, which may take long on a busy machine.
        const auto shootOnceChanged = [&] {
          constexpr int kMostTries = 60;
          for (int i = 0; i < kMostTries && settledPixels(window).values == shown.back(); ++i) sleepFor(0.5);
          shoot();
        };
        sleepFor(5);  // all shaders are compiled once
        shoot();
        writeFile(file, original.substr(0, end) + "  outColour.rgb = outColour.brg;\n" + original.substr(end));
        shootOnceChanged();
        writeFile(file, original.substr(0, end) + "  nonsense;\n" + original.substr(end));
        shootOnceChanged();
        writeFile(file, original);
        shootOnceChanged();
      });
  std::array<std::vector<std::uint8_t>, 4> seen;
  for (int i = 0; i < 4; ++i) {
    const fs::path shot = folder / ("view_000" + std::to_string(i + 1) + ".png");
    REQUIRE(fs::exists(shot));
    seen[std::size_t(i)] = readImage(shot).values;
  }
  REQUIRE(shown.size() == 4);
  for (const std::size_t i : {0, 1, 3}) CHECK((shown[i] == seen[i]));  // image 2 shows the compiler's message
  CHECK(seen[1] != seen[0]);
  CHECK(seen[2] == seen[1]);  // the last valid shader is used
  CHECK(seen[3] == seen[0]);
  std::string warnings;
  for (const auto& line : report["warnings"]) warnings += line.get<std::string>();
  CHECK_THAT(warnings, Contains("composite.frag") && Contains("nonsense"));
}

TEST_CASE("the viewer prints its help and version, and reports wrong options and a missing display") {
  const auto run = [](std::vector<std::string> arguments, std::vector<std::string> environment = {}) {
    return runProgram(arguments, {.program = IBR_VIEWER, .environment = std::move(environment)});
  };
  const auto help = run({"--help"});
  CHECK(help.code == 0);
  CHECK_THAT(help.out, Contains("ibr-viewer scene") && Contains("--preset") && Contains("--screenshot"));
  CHECK_THAT(run({"--version"}).out, Contains("ibr-viewer"));
  const auto wrong = run({"--nonsense"});
  CHECK(wrong.code == 1);
  CHECK_THAT(wrong.err, Contains("--nonsense") && Contains("--help"));
  const auto blind = run({"--frames", "1"}, {"DISPLAY=:987654", "WAYLAND_DISPLAY="});
  CHECK(blind.code == 5);
  CHECK_THAT(blind.err, Contains("window"));
}
