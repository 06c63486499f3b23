// SPDX-License-Identifier: Apache-2.0
// The program `ibr-viewer`, driven by keys and the mouse as a person would.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "ibr/metrics.h"
#include "io/image_file.h"
#include "run_program.h"
#include "support/htm_files.h"
#include "support/temporary_folder.h"
#include "tiny_scene.h"
#include "virtual_display.h"
#include "x11_window.h"

namespace fs = std::filesystem;
using namespace ibr;
using Catch::Contains;
using nlohmann::json;
using test::Hands;
using test::sleepFor;
using test::xdotool;

namespace {

test::Outcome view(std::vector<std::string> arguments, std::vector<std::string> environment = {}) {
  for (const char* word : {"--forget", "--validation", "--json", "-"}) arguments.emplace_back(word);
  const auto outcome = test::runProgram(arguments, {.program = IBR_VIEWER, .environment = std::move(environment)});
  CHECK_THAT(outcome.err, !Contains("Vulkan validation"));
  return outcome;
}

// Whether it comes about before long.
bool comes(const std::function<bool()>& what) {
  for (int tries = 0; tries < 600; ++tries, sleepFor(0.1))
    if (what()) return true;
  return false;
}

// The last place is on the screen, as the title says.
void waitForPlace(const std::string& window) {
  comes([&] { return xdotool({"getwindowname", window}).find(" - ibr") != std::string::npos; });
}

// The window's pixels, once nothing moves in it.
Image8 settledPixels(const std::string& window) {
  Image8 pixels, before;
  comes([&] {
    sleepFor(0.4);
    before = std::exchange(pixels, test::pixelsOf(window));
    return pixels.width > 0 && pixels.values == before.values;
  });
  return pixels;
}

// What a person did, and what the viewer says about it when it has closed.
json whileViewing(std::vector<std::string> arguments, const std::function<void(const std::string& window)>& act,
                  std::vector<std::string> environment = {}) {
  test::Outcome outcome;
  {
    const bool opens = fs::exists(fs::path(arguments[0]) / "scene.gltf");
    const Hands hands([&](const std::string& window) {
      if (opens) waitForPlace(window);
      act(window);
    });
    outcome = view(std::move(arguments), std::move(environment));
  }
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  return json::parse(outcome.out);
}

bool canView() {
  return test::deviceIsThere() && test::displayIsThere();
}

glm::dvec3 positionOf(const json& place) {
  return {place["position"][0], place["position"][1], place["position"][2]};
}
glm::dquat rotationOf(const json& place) {
  const json& q = place["rotation"];
  return {q[3].get<double>(), q[0].get<double>(), q[1].get<double>(), q[2].get<double>()};
}

void hold(const char* key, double seconds) {
  xdotool({"keydown", key});
  sleepFor(seconds);
  xdotool({"keyup", key});
}

// Two keys of a path, and a picture from the first.
void recordPath() {
  xdotool({"key", "k"});
  xdotool({"key", "p"});
  sleepFor(1);
  hold("w", 0.4);
  sleepFor(0.8);
  xdotool({"key", "k"});
  sleepFor(0.2);
}

void pressAll(const std::vector<std::string>& keys) {
  for (const std::string& key : keys) {
    xdotool({"key", key});
    sleepFor(0.4);  // a key acts on what the frame before has shown
  }
}

// A small harmonised model, `folder`/model.
void makeModel(const test::TemporaryFolder& folder) {
  test::BumpyOptions body;
  body.cameras = 4;
  body.longitudes = 12;
  body.latitudes = 8;
  test::writeHtmFiles(test::bumpyModel(body), folder / "files");
  REQUIRE(test::runProgram({"htm", "build", "--mesh", folder / "files/mesh.obj", "--model", folder / "files/sparse",
                            "--images", folder / "files/images", "-o", folder / "model", "--faces", "0", "--rounds",
                            "1", "--adjust", "0", "--radius", "2"})
              .code == 0);
}

// Of windows of 640×480, where neither the side panel with its hints nor a message lies.
bool sameBesidePanel(const Image8& window, const Image8& picture) {
  for (int y = 0; y < 400; ++y)
    for (int x = 0; x < 240; ++x)
      if (!std::ranges::equal(window.pixel(x, y), picture.pixel(x, y))) return false;
  return true;
}

bool hasFfmpeg() {
  return std::system("command -v ffmpeg >/dev/null && command -v ffprobe >/dev/null") == 0;
}

}  // namespace

TEST_CASE("the viewer's screenshot is what ibr render draws") {
  if (!canView()) return;
  test::TemporaryFolder folder;
  const fs::path shot = folder / "shot.png";
  const auto outcome =
      view({test::tinyScene(), "--size", "320x240", "--frames", "3", "--screenshot", shot, "--preset", "accurate"});
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  const json report = json::parse(outcome.out);
  CHECK(report["size"] == json::array({320, 240}));
  const json& place = report["places"][0];
  writeFile(
      folder / "path.json",
      json{{"version", 1},
           {"size", report["size"]},
           {"fps", 1},
           {"keys",
            {{{"time", 0}, {"position", place["position"]}, {"rotation", place["rotation"]}, {"fovY", place["fovY"]}}}}}
          .dump());
  REQUIRE(test::runProgram({"render", test::tinyScene(), "--poses", folder / "path.json", "-o", folder / "rendered",
                            "--preset", "accurate"})
              .code == 0);
  const Image8 seen = readImage(shot), rendered = readImage(folder / "rendered/frame_0000.png");
  CHECK(seen.width == 320);
  CHECK(seen.values == rendered.values);
  CHECK(readFile(shot) == readFile(folder / "rendered/frame_0000.png"));
}

TEST_CASE("a harmonised model's screenshot is what ibr render draws, and tells its view") {
  if (!canView()) return;
  test::TemporaryFolder folder;
  makeModel(folder);
  const auto outcome =
      view({folder / "model", "--size", "200x150", "--frames", "2", "--screenshot", folder / "shot.png"});
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  const auto rendered = test::runProgram(
      {"render", folder / "model", "--poses", folder / "shot.png", "-o", folder / "out", "--json", "-"});
  INFO(rendered.err);
  REQUIRE(rendered.code == 0);
  const std::string file = json::parse(rendered.out)["views"][0]["file"];
  CHECK(readFile(file) == readFile(folder / "shot.png"));
}

TEST_CASE("keys and the mouse move the view") {
  if (!canView()) return;
  const auto begin = json::parse(view({test::tinyScene(), "--size", "320x240", "--frames", "2"}).out)["places"][0];
  const glm::dvec3 from = positionOf(begin), forward = rotationOf(begin) * glm::dvec3(0, 0, -1);
  const auto forwards =
      whileViewing({test::tinyScene(), "--size", "320x240"}, [](const std::string&) { hold("w", 0.6); })["places"][0];
  const glm::dvec3 way = positionOf(forwards) - from;
  CHECK(glm::dot(way, forward) > 0.01);
  CHECK(glm::length(way - forward * glm::dot(way, forward)) < 1e-9);
  CHECK(rotationOf(forwards) == rotationOf(begin));

  const auto turned =
      whileViewing({test::tinyScene(), "--size", "320x240", "--no-interface"}, [](const std::string& w) {
        xdotool({"mousemove", "--window", w, "100", "100"});
        xdotool({"mousedown", "3"});
        sleepFor(0.2);
        for (int i = 0; i < 5; ++i, sleepFor(0.1)) xdotool({"mousemove_relative", "10", "0"});
        xdotool({"mouseup", "3"});
        sleepFor(0.3);
      })["places"][0];
  CHECK(positionOf(turned) == from);
  const glm::dvec3 right = rotationOf(begin) * glm::dvec3(1, 0, 0);
  CHECK(glm::dot(rotationOf(turned) * glm::dvec3(0, 0, -1), right) > 0.02);  // the view follows the mouse

  const auto next = whileViewing({test::tinyScene(), "--size", "320x240"}, [](const std::string&) {
    xdotool({"key", "bracketright"});
    sleepFor(1.5);
  })["places"][0];
  CHECK(glm::distance(positionOf(next), from) > 0.01);
}

TEST_CASE("keys alone look around, go through the panel, and change a setting there") {
  if (!canView()) return;
  const auto begin = json::parse(view({test::tinyScene(), "--size", "640x480", "--frames", "2"}).out)["places"][0];
  const auto looked = whileViewing({test::tinyScene(), "--size", "640x480"},
                                   [](const std::string&) { hold("Right", 0.3); })["places"][0];
  CHECK(looked["position"] == begin["position"]);
  const glm::dvec3 right = rotationOf(begin) * glm::dvec3(1, 0, 0);
  CHECK(glm::dot(rotationOf(looked) * glm::dvec3(0, 0, -1), right) > 0.02);

  // As slowly as a slow device draws: a key acts on what the frame before has shown.
  const auto chosen = whileViewing({test::tinyScene(), "--size", "640x480"}, [](const std::string&) {
    for (const char* key :
         {"2", "F6", "Down", "Down", "Down", "Down", "space", "Down"}) {  // the place, pages in two rows, presets
      xdotool({"key", key});
      sleepFor(0.4);
    }
    for (const char* key : {"w", "k", "bracketright", "l"})
      hold(key, 0.2);  // are the panel's, which has no use for them
  })["places"][0];
  CHECK(chosen["settings"] != begin["settings"]);
  CHECK(positionOf(chosen) == positionOf(begin));
  CHECK(rotationOf(chosen) == rotationOf(begin));

  const auto back = whileViewing({test::tinyScene(), "--size", "640x480"}, [](const std::string&) {
    for (const char* key : {"F6", "Down", "F6"}) {
      xdotool({"key", key});
      sleepFor(0.4);
    }
    hold("w", 0.4);
    hold("Right", 0.3);
  })["places"][0];
  CHECK(back["settings"] == begin["settings"]);
  CHECK(positionOf(back) != positionOf(begin));
  CHECK(rotationOf(back) != rotationOf(begin));
}

TEST_CASE("the interface is as large as the monitor, an option or keys ask for, and the mouse hits it") {
  if (!canView()) return;
  test::TemporaryFolder folder;
  // Where the side panel is seen: columns and rows in which the window differs from the picture without it.
  struct Seen {
    int left = 10000, bottom = 0;
  };
  const auto seen = [&](std::vector<std::string> more, const std::function<void(const std::string&)>& act = {}) {
    std::vector<std::string> arguments{test::tinyScene(), "--size", "900x700", "--screenshot", folder / "bare.png"};
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
    const auto place = whileViewing({test::tinyScene(), "--size", "900x700", "--interface-scale", "1.25"},
                                    [&](const std::string& window) {
                                      xdotool({"mousemove", "--window", window, std::to_string(x), "200"});
                                      sleepFor(0.5);
                                      xdotool({"mousedown", "3"});
                                      for (int i = 0; i < 4; ++i, sleepFor(0.2))
                                        xdotool({"mousemove_relative", "0", "9"});
                                      xdotool({"mouseup", "3"});
                                      sleepFor(0.3);
                                    })["places"][0];
    return place["rotation"];
  };
  const Seen one = seen({}), larger = seen({"--interface-scale", "1.25"});
  const int wide = 900 - 10;  // the panel's right side
  CHECK(wide - one.left == Approx(26 * 13).margin(2));
  CHECK(wide - larger.left == Approx(26 * 16).margin(2));
  CHECK(looksFrom(larger.left - 10) != looksFrom(larger.left + 10));
  {
    const test::MonitorDpi monitor(120);
    CHECK(seen({}).left == larger.left);
  }
  const Seen keyed = seen({}, [](const std::string&) {
    xdotool({"key", "ctrl+equal"});
    sleepFor(0.5);
  });
  CHECK(keyed.left == larger.left);
  CHECK(keyed.bottom == larger.bottom);
  const Seen same = seen({}, [](const std::string&) {
    for (const char* key : {"ctrl+equal", "ctrl+minus"}) {
      xdotool({"key", key});
      sleepFor(0.5);
    }
  });
  CHECK(same.left == one.left);
  CHECK(same.bottom == one.bottom);
}

TEST_CASE("a window is resized again and again, hidden and shown, and goes on") {
  if (!canView()) return;
  test::TemporaryFolder folder;
  Image8 pixels;
  const json report =
      whileViewing({test::tinyScene(), "--size", "400x300", "--no-interface", "--screenshot", folder / "shot.png"},
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
  CHECK(pixels.values == readImage(folder / "shot.png").values);
}

TEST_CASE("several places are open, each with its own view") {
  if (!canView()) return;
  test::TemporaryFolder folder;
  fs::copy(test::tinyScene(), folder / "other", fs::copy_options::recursive);
  const auto begin = json::parse(view({test::tinyScene(), "--size", "320x240", "--frames", "2"}).out)["places"][0];
  const json report = whileViewing({test::tinyScene(), folder / "other", "--size", "320x240"}, [](const std::string&) {
    sleepFor(1);
    hold("w", 0.4);
    xdotool({"key", "ctrl+Next"});
    sleepFor(0.5);
    hold("s", 0.4);
    xdotool({"key", "ctrl+Prior"});
    sleepFor(0.5);
    hold("Right", 0.4);
  });
  REQUIRE(report["places"].size() == 2);
  const json &first = report["places"][0], &second = report["places"][1];
  CHECK_THAT(second["place"].get<std::string>(), Contains("other"));
  CHECK(report["current"] == 1);
  const auto forwards = [&](const json& place) {
    return glm::dot(positionOf(place) - positionOf(begin), rotationOf(begin) * glm::dvec3(0, 0, -1));
  };
  CHECK(forwards(first) < -0.01);
  CHECK(forwards(second) > 0.01);
  CHECK(first["rotation"] == begin["rotation"]);
  CHECK(second["rotation"] != begin["rotation"]);
}

TEST_CASE("a click on a tab shows its place") {
  if (!canView()) return;
  test::TemporaryFolder folder;
  fs::copy(test::tinyScene(), folder / "other", fs::copy_options::recursive);
  Image8 pixels, before;
  const json report =
      whileViewing({folder / "other", test::tinyScene(), "--size", "640x480", "--screenshot", folder / "shot.png"},
                   [&](const std::string& window) {
                     sleepFor(1);
                     hold("w", 0.5);
                     before = settledPixels(window);
                     xdotool({"mousemove", "--window", window, "330", "45"});
                     sleepFor(0.5);
                     xdotool({"click", "1"});
                     pixels = settledPixels(window);
                   });
  REQUIRE(report["places"].size() == 2);
  CHECK(report["current"] == 0);
  CHECK(sameBesidePanel(pixels, readImage(folder / "shot.png")));
  CHECK(!sameBesidePanel(before, readImage(folder / "shot.png")));
}

TEST_CASE("a view goes through the clipboard, and a camera path to ibr render") {
  if (!canView()) return;
  test::TemporaryFolder folder;
  const auto begin = json::parse(view({test::tinyScene(), "--size", "320x240", "--frames", "2"}).out)["places"][0];
  const auto report =
      whileViewing({test::tinyScene(), "--size", "320x240", "--screenshots", folder.path()}, [](const std::string&) {
        xdotool({"key", "ctrl+c"});
        sleepFor(0.3);
        xdotool({"key", "k"});
        hold("w", 0.4);
        sleepFor(0.8);
        xdotool({"key", "k"});
        sleepFor(0.3);
        xdotool({"key", "ctrl+s"});
        sleepFor(0.3);
        xdotool({"key", "p"});
        sleepFor(1);
        xdotool({"key", "ctrl+v"});
        sleepFor(0.5);
      });
  for (const char* field : {"position", "rotation", "fovY"})  // pasted: where it was copied
    CHECK(report["places"][0][field] == begin[field]);
  REQUIRE(fs::exists(folder / "path_0001.json"));
  REQUIRE(fs::exists(folder / "view_0001.png"));
  const json path = json::parse(readTextFile(folder / "path_0001.json"));
  REQUIRE(path["keys"].size() == 2);
  CHECK(path["size"] == json::array({320, 240}));
  CHECK(path["keys"][0]["position"] == begin["position"]);
  CHECK(path["keys"][0]["rotation"] == begin["rotation"]);
  CHECK(path["keys"][0]["fovY"] == begin["fovY"]);
  CHECK(path["keys"][1]["position"] != begin["position"]);
  const auto played = test::runProgram(
      {"render", test::tinyScene(), "--poses", folder / "path_0001.json", "-o", folder / "played", "--json", "-"});
  INFO(played.err);
  REQUIRE(played.code == 0);
  const auto single = test::runProgram(
      {"render", test::tinyScene(), "--poses", folder / "view_0001.png", "-o", folder / "single", "--json", "-"});
  REQUIRE(single.code == 0);
  const std::string shot = json::parse(single.out)["views"][0]["file"];
  CHECK(readFile(shot) == readFile(folder / "view_0001.png"));
}

TEST_CASE("a camera path becomes a video, drawn with the view's very settings") {
  if (!canView()) return;
  test::TemporaryFolder folder;
  const fs::path pictures = folder / "out/path_0001", video = folder / "out/path_0001.mp4";
  const auto framesIn = [&](const json& path) {
    const double seconds = path["keys"].back()["time"].get<double>() - path["keys"][0]["time"].get<double>();
    return std::size_t(std::floor(seconds * path["fps"].get<double>() + 1e-6)) + 1;
  };
  const auto picturesThere = [&] {
    return fs::exists(pictures) ? std::size_t(std::distance(fs::directory_iterator(pictures), {})) : 0;
  };

  SECTION("where there is ffmpeg") {
    if (!hasFfmpeg()) return;
    const json report = whileViewing({test::tinyScene(), "--size", "321x240", "--screenshots", folder / "out",
                                      "--preset", "accurate", "--cells", "1", "--blend", "mixed", "--switch", "0"},
                                     [&](const std::string&) {
                                       recordPath();
                                       xdotool({"key", "ctrl+m"});
                                       comes([&] { return fs::exists(video); });
                                     });
    CHECK(report["warnings"].empty());
    const json path = json::parse(readTextFile(folder / "out/path_0001.json"));
    CHECK(path["size"] == json::array({321, 240}));
    CHECK(picturesThere() == framesIn(path));
    CHECK(readFile(pictures / "frame_0000.png") == readFile(folder / "out/view_0001.png"));
    REQUIRE(fs::exists(video));
    CHECK(std::system(("test $(ffprobe -v error -count_frames -show_entries stream=nb_read_frames -of csv=p=0 '" +
                       video.string() + "') = " + std::to_string(framesIn(path)))
                          .c_str()) == 0);
    CHECK(path["fps"] == 30);
    CHECK(std::system(
              ("test $(ffprobe -v error -show_entries stream=r_frame_rate -of csv=p=0 '" + video.string() + "') = 30/1")
                  .c_str()) == 0);
  }
  SECTION("where there is none the pictures stay, and that is said") {
    const json report =
        whileViewing({test::tinyScene(), "--size", "320x240", "--screenshots", folder / "out"},
                     [&](const std::string&) {
                       recordPath();
                       xdotool({"key", "ctrl+m"});
                       comes([&] {
                         return fs::exists(folder / "out/path_0001.json") &&
                                picturesThere() == framesIn(json::parse(readTextFile(folder / "out/path_0001.json")));
                       });
                       sleepFor(2);
                     },
                     {"PATH=/nowhere"});
    CHECK(picturesThere() == framesIn(json::parse(readTextFile(folder / "out/path_0001.json"))));
    CHECK(!fs::exists(video));
    CHECK_THAT(report["said"].dump(), Contains(pictures.string()) && Contains("ffmpeg"));
  }
}

TEST_CASE("a harmonised model's path becomes pictures with its very settings") {
  if (!canView()) return;
  test::TemporaryFolder folder;
  makeModel(folder);
  const fs::path pictures = folder / "out/path_0001";
  const json report = whileViewing(
      {folder / "model", "--size", "640x480", "--screenshots", folder / "out"}, [&](const std::string& window) {
        waitForPlace(window);
        // Settings; the place, pages in two rows, the method: the next of its list.
        pressAll({"2", "F6", "Down", "Down", "Down", "Down", "space", "Down", "space", "F6"});
        recordPath();
        xdotool({"key", "ctrl+m"});
        comes([&] { return fs::exists(pictures / "frame_0000.png"); });
        comes([&] { return fs::exists(folder / "out/path_0001.mp4"); });
      });
  CHECK(report["warnings"].empty());
  CHECK(report["places"][0]["settings"]["method"] == "vdtbm");
  REQUIRE(fs::exists(folder / "out/view_0001.png"));
  CHECK(readFile(pictures / "frame_0000.png") == readFile(folder / "out/view_0001.png"));
  CHECK(fs::exists(pictures / "frame_0001.png"));
}

TEST_CASE("cells are muted and shown alone by keys in the list of them") {
  if (!canView()) return;
  test::TemporaryFolder folder;
  const auto after = [&](const char* shot, std::vector<std::string> keys) {
    keys.insert(keys.begin(), {"3", "F6", "Down", "Down", "Down", "Down", "space",
                               "Down"});  // the place, pages in two rows, into the list, the cell
    Image8 pixels;
    const json report = whileViewing({test::tinyScene(), "--size", "640x480", "--screenshot", folder / shot},
                                     [&](const std::string& window) {
                                       pressAll(keys);
                                       pixels = settledPixels(window);
                                     });
    CHECK(sameBesidePanel(pixels, readImage(folder / shot)));
    return report["places"][0]["settings"];
  };
  const json none = json::array();
  const json muted = after("muted.png", {"space"}), solo = after("solo.png", {"Right", "space"});
  REQUIRE(muted["mute"].size() == 1);
  CHECK(muted["solo"] == none);
  CHECK(solo["solo"] == muted["mute"]);  // in one row
  CHECK(solo["mute"] == none);
  CHECK(readImage(folder / "muted.png").values != readImage(folder / "solo.png").values);
  const json back = after("back.png", {"space", "space"});  // the cell keeps the keys, wherever it stands
  CHECK(back["mute"] == none);
  const json all = after("all.png", {"Right", "space", "Escape", "Up", "space"});
  CHECK(all["solo"] == none);
}

TEST_CASE("O goes through the overlays, and screenshots of them are drawn again as they are") {
  if (!canView()) return;
  test::TemporaryFolder folder;
  whileViewing({test::tinyScene(), "--size", "320x240", "--screenshots", folder.path(), "--mute", "99"},
               [](const std::string&) {
                 const auto shoot = [](std::vector<const char*> keys) {
                   for (const char* key : keys) {
                     xdotool({"key", key});
                     sleepFor(0.4);
                   }
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
    const auto told = test::runProgram({"info", shot, "--json", "-"});
    const json settings = json::parse(told.out)["settings"];
    CHECK(settings["overlay"] == (overlays[i] == "none" ? json() : json(overlays[i])));
    CHECK(settings["mute"].empty());
    const auto drawn = test::runProgram({"render", test::tinyScene(), "--poses", shot, "-o", folder / overlays[i],
                                         "--overlay", overlays[i], "--json", "-"});
    INFO(drawn.err);
    REQUIRE(drawn.code == 0);
    const fs::path again = json::parse(drawn.out)["views"][0]["file"].get<std::string>();
    CHECK(readImage(again).values == readImage(shot).values);
  }
  CHECK(readImage(folder / "view_0001.png").values != readImage(folder / "view_0003.png").values);
  CHECK(readImage(folder / "view_0002.png").values != readImage(folder / "view_0003.png").values);
}

TEST_CASE("what is being made is stopped by keys alone") {
  if (!canView()) return;
  test::TemporaryFolder folder;
  const json report =
      whileViewing({test::tinyScene(), "--size", "640x480", "--screenshots", folder / "out"}, [&](const std::string&) {
        xdotool({"key", "k"});
        hold("w", 6);  // a path that takes long to draw
        xdotool({"key", "k"});
        sleepFor(0.5);
        for (const char* key : {"ctrl+m", "F6", "F6", "Down", "space"}) {
          xdotool({"key", key});
          sleepFor(0.4);
        }
        sleepFor(1);
      });
  CHECK(fs::exists(folder / "out/path_0001.json"));
  CHECK(!fs::exists(folder / "out/path_0001.mp4"));
  CHECK_THAT(report["said"].dump(), Contains("stopped"));
  CHECK(report["warnings"].empty());
}

TEST_CASE("a shader that is edited shows at once, a broken one shows what the compiler says") {
  if (!canView()) return;
  test::TemporaryFolder folder;
  fs::copy(IBR_SHADERS, folder / "shaders", fs::copy_options::recursive);
  const fs::path file = folder / "shaders/render/composite.frag";
  const std::string original = readTextFile(file);
  const std::size_t end = original.rfind('}');
  REQUIRE(end != std::string::npos);
  std::vector<std::vector<std::uint8_t>> shown;  // in the window
  const auto report = whileViewing(
      {test::tinyScene(), "--size", "320x240", "--no-interface", "--screenshots", folder.path(), "--shaders",
       folder / "shaders"},
      [&](const std::string& window) {
        const auto shoot = [&] {
          shown.push_back(settledPixels(window).values);
          xdotool({"key", "p"});
          sleepFor(1.2);
        };
        sleepFor(5);  // all of them are compiled once
        shoot();
        writeFile(file, original.substr(0, end) + "  outColour.rgb = outColour.brg;\n" + original.substr(end));
        sleepFor(3);
        shoot();
        writeFile(file, original.substr(0, end) + "  nonsense;\n" + original.substr(end));
        sleepFor(3);
        shoot();
        writeFile(file, original);
        sleepFor(3);
        shoot();
      });
  std::array<std::vector<std::uint8_t>, 4> seen;
  for (int i = 0; i < 4; ++i) {
    const fs::path shot = folder / ("view_000" + std::to_string(i + 1) + ".png");
    REQUIRE(fs::exists(shot));
    seen[std::size_t(i)] = readImage(shot).values;
  }
  REQUIRE(shown.size() == 4);
  for (const std::size_t i : {0, 1, 3}) CHECK((shown[i] == seen[i]));  // over 2 the compiler's text lies
  CHECK(seen[1] != seen[0]);
  CHECK(seen[2] == seen[1]);  // the last that could be used
  CHECK(seen[3] == seen[0]);
  std::string warnings;
  for (const auto& line : report["warnings"]) warnings += line.get<std::string>();
  CHECK_THAT(warnings, Contains("composite.frag") && Contains("nonsense"));
}

TEST_CASE("a picture that cannot be written is said, and the window stays") {
  if (!canView()) return;
  test::TemporaryFolder folder;
  writeFile(folder / "file", "in the way");
  const auto report = whileViewing({test::tinyScene(), "--size", "320x240", "--screenshots", folder / "file/below"},
                                   [](const std::string&) {
                                     xdotool({"key", "p"});
                                     sleepFor(0.7);
                                     xdotool({"key", "k"});
                                     xdotool({"key", "ctrl+s"});
                                     sleepFor(0.5);
                                   });
  CHECK(report["places"].size() == 1);
  CHECK(report["warnings"].size() == 2);
}

TEST_CASE("pictures go into the user's folder for them") {
  if (!canView()) return;
  test::TemporaryFolder home;
  const std::vector<std::string> environment{"HOME=" + home.path().string(), "XDG_CONFIG_HOME="};
  const auto folderToldIn = [&](const test::RunOptions& options) {
    const std::string help = test::runProgram({"--help"}, options).out;
    const std::size_t from = help.find("camera paths and videos");
    return help.substr(from, help.find(']', from) - from);
  };
  const test::RunOptions options{.program = IBR_VIEWER, .environment = environment};
  CHECK_THAT(folderToldIn(options), Contains(fs::current_path().string()));  // there is no such folder
  fs::create_directories(home / "Pictures");
  CHECK_THAT(folderToldIn(options), Contains((home / "Pictures/ibr").string()));
  fs::create_directories(home / "Meine Bilder");
  fs::create_directories(home / ".config");
  writeFile(home / ".config/user-dirs.dirs",
            "# comment\nXDG_DESKTOP_DIR=\"$HOME/\"\nXDG_PICTURES_DIR=\"$HOME/Meine Bilder\"\n");
  const auto report = whileViewing(
      {test::tinyScene(), "--size", "320x240"},
      [](const std::string&) {
        xdotool({"key", "p"});
        sleepFor(1);
      },
      environment);
  CHECK(fs::exists(home / "Meine Bilder/ibr/view_0001.png"));
  CHECK_THAT(report["said"].dump(), Contains((home / "Meine Bilder/ibr/view_0001.png").string()));
}

TEST_CASE("a bounded view stays near the photographs") {
  if (!canView()) return;
  const auto away = [](bool bounded) {
    const auto report = whileViewing({test::tinyScene(), "--size", "320x240"}, [&](const std::string&) {
      if (bounded) xdotool({"key", "b"});
      sleepFor(0.2);
      hold("Shift_L+w", 2.5);
      sleepFor(0.5);
    });
    return glm::length(positionOf(report["places"][0]));
  };
  CHECK(away(true) < 0.6 * away(false));
}

TEST_CASE("the middle button goes round the point that it is pressed on") {
  if (!canView()) return;
  const auto begin = json::parse(view({test::tinyScene(), "--size", "320x240", "--frames", "2"}).out)["places"][0];
  CHECK(begin["centre"].is_null());
  const json place = whileViewing({test::tinyScene(), "--size", "320x240", "--no-interface"}, [](const std::string& w) {
    xdotool({"mousemove", "--window", w, "203", "113"});
    sleepFor(0.2);
    xdotool({"mousedown", "2"});
    sleepFor(0.5);
    for (int i = 0; i < 5; ++i, sleepFor(0.1)) xdotool({"mousemove_relative", "4", "0"});
    xdotool({"mouseup", "2"});
    sleepFor(0.3);
  })["places"][0];
  REQUIRE(!place["centre"].is_null());
  const glm::dvec3 centre(place["centre"][0], place["centre"][1], place["centre"][2]);
  const glm::dvec3 from = positionOf(begin), to = positionOf(place);
  // The board is 3.5 ahead, the wall around it 5.
  const glm::dvec3 seen = glm::conjugate(rotationOf(begin)) * (centre - from);
  const double focal = 120 / std::tan(0.5 * begin["fovY"].get<double>());
  CHECK(seen.z == Approx(-3.5).epsilon(0.05));
  CHECK(seen.x / -seen.z == Approx((203.5 - 160) / focal).margin(1 / focal));
  CHECK(glm::distance(centre, to) == Approx(glm::distance(centre, from)));
  CHECK(glm::distance(from, to) > 0.2);
}

TEST_CASE("lines of the image graph are in pictures as ibr render draws them") {
  if (!canView()) return;
  test::TemporaryFolder folder;
  whileViewing({test::tinyScene(), "--size", "320x240", "--screenshots", folder.path()}, [](const std::string&) {
    hold("s", 0.6);
    sleepFor(0.8);
    xdotool({"key", "p"});
    sleepFor(0.8);
    xdotool({"key", "g"});
    sleepFor(0.3);
    xdotool({"key", "p"});
    sleepFor(1);
  });
  const auto redrawn = [&](const char* shot, std::vector<std::string> further) {
    further.insert(further.begin(),
                   {"render", test::tinyScene(), "--poses", folder / shot, "-o", folder / "again", "--json", "-"});
    const auto outcome = test::runProgram(further);
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    return readFile(json::parse(outcome.out)["views"][0]["file"].get<std::string>());
  };
  CHECK(bool(redrawn("view_0001.png", {}) == readFile(folder / "view_0001.png")));
  CHECK(bool(redrawn("view_0002.png", {"--graph"}) == readFile(folder / "view_0002.png")));
  CHECK(difference(readImage(folder / "view_0001.png"), readImage(folder / "view_0002.png"), 30).shareAbove > 0.005);
}

TEST_CASE("a camera path is shown from the start, again and again") {
  if (!canView()) return;
  test::TemporaryFolder folder;
  const json rotation{0.0, 0.0, 0.0, 1.0};
  writeFile(folder / "path.json",
            json{{"version", 1},
                 {"size", {320, 240}},
                 {"fps", 30},
                 {"keys",
                  {{{"time", 0}, {"position", {7, 0, 1}}, {"rotation", rotation}, {"fovY", 0.8}},
                   {{"time", 0.2}, {"position", {7.1, 0, 1}}, {"rotation", rotation}, {"fovY", 0.8}}}}}
                .dump());
  const auto outcome = view({test::tinyScene(), "--size", "320x240", "--path", folder / "path.json", "--frames", "60"});
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  const json report = json::parse(outcome.out);
  const glm::dvec3 at = positionOf(report["places"][0]);
  CHECK(at.x >= 7);
  CHECK(at.x <= 7.1);
  CHECK(report["places"][0]["fovY"] == Approx(0.8));
  CHECK(report["times"]["framesMs"]["count"] > 50);
  CHECK(report["times"]["framesMs"]["p50"] > 0);
  CHECK(report["times"]["framesMs"]["p95"] >= report["times"]["framesMs"]["p50"]);
  CHECK(report["times"]["firstPicture"] > 0);
  CHECK(report["residentBytes"] > 20'000'000);  // a device's driver alone is larger
  // Long after its end it goes on.
  whileViewing({test::tinyScene(), "--size", "320x240", "--path", folder / "path.json", "--screenshots", folder.path()},
               [](const std::string&) {
                 for (int i = 0; i < 2; ++i) {
                   sleepFor(1.5);
                   xdotool({"key", "p"});
                 }
                 sleepFor(1);
               });
  const auto told = [&](const char* shot) { return test::runProgram({"info", folder / shot, "--json", "-"}).out; };
  REQUIRE(fs::exists(folder / "view_0002.png"));
  CHECK(json::parse(told("view_0001.png"))["view"]["position"] !=
        json::parse(told("view_0002.png"))["view"]["position"]);
  writeFile(folder / "path.json", "{}");
  const auto bad = view({test::tinyScene(), "--path", folder / "path.json", "--frames", "2"});
  CHECK(bad.code != 0);
  CHECK_THAT(bad.err, Contains("path.json"));
}

TEST_CASE("what is typed into a slider keeps within its bounds, and the place stays") {
  if (!canView()) return;
  const json report = whileViewing({test::tinyScene(), "--size", "500x400"}, [](const std::string& w) {
    for (const char* page : {"1", "2"}) {
      xdotool({"key", page});
      sleepFor(0.4);
      // Where sliders are, on one page or the other.
      for (const int y : {154, 177, 223, 310, 333}) {
        xdotool({"mousemove", "--window", w, "270", std::to_string(y)});
        xdotool({"keydown", "ctrl", "click", "1", "keyup", "ctrl"});
        sleepFor(0.3);
        xdotool({"type", "--", "-3000"});
        xdotool({"key", "Return"});
        sleepFor(0.3);
      }
    }
  });
  REQUIRE(report["places"].size() == 1);
  CHECK(report["warnings"].empty());
  CHECK(report["places"][0]["fovY"] == Approx(glm::radians(10.0)));  // the least that there is
  CHECK(report["places"][0]["settings"]["extrapolation"] >= 0);
}

TEST_CASE("who moves the view while a path is shown gets it") {
  if (!canView()) return;
  test::TemporaryFolder folder;
  const json rotation{0.0, 0.0, 0.0, 1.0};
  writeFile(folder / "path.json",
            json{{"version", 1},
                 {"size", {320, 240}},
                 {"fps", 30},
                 {"keys",
                  {{{"time", 0}, {"position", {7, 0, 1}}, {"rotation", rotation}, {"fovY", 0.8}},
                   {{"time", 20}, {"position", {9, 0, 1}}, {"rotation", rotation}, {"fovY", 0.8}}}}}
                .dump());
  const json report =
      whileViewing({test::tinyScene(), "--size", "320x240", "--path", folder / "path.json"}, [](const std::string&) {
        xdotool({"key", "bracketright"});
        sleepFor(2);
      });
  const glm::dvec3 at = positionOf(report["places"][0]);
  double nearest = 1e9;
  for (const test::NamedCamera& c : test::tinySet().cameras)
    nearest = std::min(nearest, glm::distance(at, c.camera.pose.position));
  CHECK(nearest < 1e-6);
}

TEST_CASE("presets are measured where the view stands") {
  if (!canView()) return;
  const json place =
      whileViewing({test::tinyScene(), "--size", "500x400", "--preset", "accurate"}, [](const std::string& w) {
        xdotool({"key", "2"});
        sleepFor(0.5);
        // Where the buttons of the last preset and of what measures stand, more or less.
        for (int y = 224; y > 195; y -= 6)
          xdotool({"mousemove", "--window", w, "280", std::to_string(y), "click", "1"});
        sleepFor(5);
      })["places"][0];
  const json& effects = place["effects"];
  INFO(effects.dump());
  for (const char* name : {"fast", "balanced", "accurate", "reference", "as set"}) {
    REQUIRE(effects.contains(name));
    CHECK(effects[name]["ms"] > 0);
  }
  CHECK(effects["reference"]["psnr"].is_null());
  CHECK(effects["fast"]["psnr"] > 10);
  CHECK(effects["fast"]["psnr"] < effects["accurate"]["psnr"]);
}

TEST_CASE("a view that stands says how far it may be trusted") {
  if (!canView()) return;
  const auto after = [](const char* key, double seconds) {
    return whileViewing({test::tinyScene(), "--size", "320x240"}, [&](const std::string&) {
      if (seconds > 0) hold(key, seconds);
      sleepFor(2);
    })["places"][0];
  };
  const json at = after("", 0)["trust"], behind = after("s", 0.4), away = after("s", 2.5)["trust"];
  for (const json& trust : {at, behind["trust"], away}) REQUIRE(trust.is_object());
  double sum = 0;
  for (const json& share : at["tiers"]) sum += share.get<double>();
  CHECK(sum == Approx(1));
  CHECK(at["tiers"][0] > 0.4);
  CHECK(at["extrapolation"] < 1e-6);
  // The photographs stand in the plane z = 0, the furthest two half a unit apart.
  CHECK(behind["trust"]["extrapolation"] == Approx(positionOf(behind).z / 0.5).epsilon(1e-6));
  CHECK(away["extrapolation"].is_null());  // infinite: no cell is near
  CHECK(away["tiers"][0] < at["tiers"][0]);
}

TEST_CASE("places are closed, by key and by their tab's cross, and nothing of them stays") {
  if (!canView()) return;
  test::TemporaryFolder folder;
  for (const char* name : {"a", "b"}) fs::copy(test::tinyScene(), folder / name, fs::copy_options::recursive);
  const std::vector<std::string> all{folder / "a", folder / "b", test::tinyScene(), "--size", "500x400"};
  const json byKey = whileViewing(all, [](const std::string&) {
    sleepFor(1);
    for (const char* key : {"ctrl+Next", "ctrl+w", "ctrl+w"}) {
      xdotool({"key", key});
      sleepFor(0.5);
    }
  });
  REQUIRE(byKey["places"].size() == 1);
  CHECK(byKey["onDevice"] == 1);
  const json byCross = whileViewing(all, [](const std::string& w) {
    sleepFor(1);
    // Wherever the crosses are: a click closes a tab, chooses one, or does nothing.
    for (int x = 250; x < 400; x += 3) xdotool({"mousemove", "--window", w, std::to_string(x), "45", "click", "1"});
    sleepFor(0.5);
  });
  CHECK(byCross["places"].size() < 3);
  const json none = whileViewing(all, [](const std::string&) {
    sleepFor(1);
    for (int i = 0; i < 4; ++i, sleepFor(0.3)) xdotool({"key", "ctrl+w"});
  });
  CHECK(none["places"].empty());
  CHECK(none["onDevice"] == 0);
}

TEST_CASE("what cannot be opened is said, and the window stays") {
  if (!canView()) return;
  test::TemporaryFolder folder;
  writeFile(folder / "scene.gltf", "{");
  const auto outcome = view({folder / "none", folder.path(), test::tinyScene(), "--frames", "2", "--size", "320x240"});
  CHECK(outcome.code == 0);
  const json report = json::parse(outcome.out);
  CHECK(report["places"].size() == 1);
  CHECK(report["warnings"].size() == 2);
  CHECK_THAT(outcome.err, Contains("none") && Contains("missing"));
  CHECK(view({folder / "none", "--frames", "2"}).code == 4);
}

TEST_CASE("a device that is lost is made anew, and everything with it") {
  if (!canView()) return;
  test::TemporaryFolder folder;
  const auto shown = [&](const char* name, std::vector<std::string> more) {
    std::vector<std::string> arguments{test::tinyScene(), "--size",     "320x240", "--frames", "5",
                                       "--screenshot",    folder / name};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return view(arguments);
  };
  REQUIRE(shown("kept.png", {}).code == 0);
  const auto outcome = shown("lost.png", {"--lose-device", "3"});
  CHECK(outcome.code == 0);
  CHECK_THAT(outcome.err, Contains("lost"));
  CHECK(readFile(folder / "lost.png") == readFile(folder / "kept.png"));
}

TEST_CASE("the window shows the picture's very values, whatever its format") {
  if (!canView()) return;
  test::TemporaryFolder folder;
  const auto seen = [&](const char* name, std::vector<std::string> more) {
    std::vector<std::string> arguments{test::tinyScene(), "--size", "320x240", "--screenshot", folder / name};
    arguments.insert(arguments.end(), more.begin(), more.end());
    Image8 pixels;
    whileViewing(arguments, [&](const std::string& window) { pixels = settledPixels(window); });
    return pixels;
  };
  const Image8 bare = seen("bare.png", {"--no-interface"});
  const Image8 srgb = seen("srgb.png", {"--no-interface", "--only-srgb"});
  CHECK(bare.values == readImage(folder / "bare.png").values);
  CHECK(srgb.values == bare.values);
  CHECK(readFile(folder / "srgb.png") == readFile(folder / "bare.png"));
  // The interface too, where nothing moves: the panel's texts lie over the picture.
  const Image8 with = seen("with.png", {}), withSrgb = seen("with_srgb.png", {"--only-srgb"});
  CHECK(with.values == withSrgb.values);
  CHECK(with.values != readImage(folder / "with.png").values);
}

TEST_CASE("a window's surface that is lost is made anew") {
  if (!canView()) return;
  Image8 pixels;
  test::TemporaryFolder folder;
  whileViewing({test::tinyScene(), "--size", "320x240", "--no-interface", "--lose-surface", "3", "--screenshot",
                folder / "shot.png"},
               [&](const std::string& window) {
                 xdotool({"key", "bracketright"});  // frames go on
                 sleepFor(1);
                 pixels = settledPixels(window);
               });
  CHECK(pixels.values == readImage(folder / "shot.png").values);
}

TEST_CASE("a folder that is dropped on the window is opened") {
  if (!canView()) return;
  test::TemporaryFolder folder;
  fs::copy(test::tinyScene(), folder / "a scene", fs::copy_options::recursive);
  const json report = whileViewing({"--size", "320x240"}, [&](const std::string& window) {
    test::dropOnto(window, {folder / "a scene", test::tinyScene()});
    sleepFor(1.5);
  });
  REQUIRE(report["places"].size() == 2);
  CHECK(report["places"][0]["place"] == (folder / "a scene").string());
}

TEST_CASE("a folder is typed, completed and opened by keys alone") {
  if (!canView()) return;
  test::TemporaryFolder folder;
  for (const char* name : {"the scene", "other"})
    fs::copy(test::tinyScene(), folder / name, fs::copy_options::recursive);
  Image8 pixels;
  const json report = whileViewing({"--size", "640x480", "--no-interface", "--screenshot", folder / "shot.png"},
                                   [&](const std::string& window) {
                                     const auto type = [](std::vector<std::string> keys) {
                                       for (const std::string& key : keys) {
                                         xdotool({"key", key});
                                         sleepFor(0.4);
                                       }
                                     };
                                     const auto write = [](const std::string& text) {
                                       xdotool({"type", "--delay", "40", text});
                                       sleepFor(0.4);
                                     };
                                     type({"ctrl+o"});
                                     write((folder / "the").string());
                                     type({"Tab", "Return"});
                                     waitForPlace(window);
                                     type({"ctrl+o", "ctrl+a"});
                                     write((folder / "none").string());
                                     type({"Return"});
                                     type({"ctrl+o", "ctrl+a"});
                                     write((folder / "other").string());
                                     type({"Escape", "bracketright"});  // not opened; keys are the view's again
                                     sleepFor(1.2);
                                     hold("Right", 0.3);
                                     pixels = settledPixels(window);
                                   });
  REQUIRE(report["places"].size() == 1);
  CHECK(report["places"][0]["place"] == (folder / "the scene/").string());
  REQUIRE(report["warnings"].size() == 1);
  CHECK_THAT(report["warnings"][0].get<std::string>(), Contains("none") && Contains("missing"));
  const auto begin = json::parse(view({test::tinyScene(), "--size", "640x480", "--frames", "2"}).out)["places"][0];
  CHECK(positionOf(report["places"][0]) != positionOf(begin));
  CHECK(rotationOf(report["places"][0]) != rotationOf(begin));
  CHECK(report["places"][0]["settings"] == begin["settings"]);  // what was typed did nothing else
  CHECK(pixels.values == readImage(folder / "shot.png").values);
}

TEST_CASE("a folder of photographs becomes a scene beside the viewer") {
  if (!canView()) return;
  test::TemporaryFolder folder;
  fs::copy(test::tinySet().photographs, folder / "photos", fs::copy_options::recursive);
  const auto outcome = view({folder / "photos", folder / "photos/", "--size", "320x240", "--frames", "2",
                             "--screenshot", folder / "shot.png"});
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  std::size_t begun = 0;
  const json said = json::parse(outcome.out)["said"];
  for (const json& line : said)
    begun += line.get<std::string>().find("making a scene") != std::string::npos;
  CHECK(begun == 1);  // though it was asked for twice
  CHECK(fs::exists(folder / "photos-scene/scene.gltf"));
  const json report = json::parse(outcome.out);
  REQUIRE(report["places"].size() == 1);
  CHECK_THAT(report["places"][0]["place"].get<std::string>(), Contains("photos-scene"));

  fs::create_directories(folder / "broken/sparse");
  writeFile(folder / "broken/a.jpg", "no picture");
  writeFile(folder / "broken/b.jpg", "no picture");
  writeFile(folder / "broken/sparse/images.txt", "no model");
  const auto broken = view({folder / "broken", test::tinyScene(), "--size", "320x240", "--frames", "2"});
  CHECK(broken.code == 0);
  CHECK_THAT(json::parse(broken.out)["warnings"].dump(), Contains("broken-scene"));
  CHECK(json::parse(broken.out)["places"].size() == 1);
}

TEST_CASE("building is stopped when the viewer is closed") {
  if (!canView()) return;
  test::TemporaryFolder folder;
  fs::copy(test::tinySet().photographs, folder / "photos", fs::copy_options::recursive);
  // So large that making a scene of them takes long.
  for (const char* name : {"a/0.png", "a/1.png", "b/2.png"}) {
    const Image8 small = readImage(folder / "photos" / name);
    constexpr int kLarger = 10;
    Image8 large(kLarger * small.width, kLarger * small.height, 3);
    for (int y = 0; y < large.height; ++y)
      for (int x = 0; x < large.width; ++x)
        std::ranges::copy(small.pixel(x / kLarger, y / kLarger).first(3), large.pixel(x, y).begin());
    writeImage(folder / "photos" / name, large);
  }
  whileViewing({folder / "photos", "--size", "320x240"}, [](const std::string&) {});  // closed at once
  CHECK(!fs::exists(folder / "photos-scene/scene.gltf"));
  CHECK(std::system(("pgrep -f '" + (folder / "photos").string() + "[-]scene' >/dev/null").c_str()) != 0);
}

TEST_CASE("the viewer says what it is and what it needs") {
  const auto run = [](std::vector<std::string> arguments, std::vector<std::string> environment = {}) {
    return test::runProgram(arguments, {.program = IBR_VIEWER, .environment = std::move(environment)});
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
