// SPDX-License-Identifier: Apache-2.0
// Documents of the viewer: opening, closing, several at once, and background builds.
#include "ibr/scene.h"
#include "support/json.h"
#include "viewer_harness.h"

#include <nlohmann/json.hpp>

namespace fs = std::filesystem;
using namespace ibr;
using namespace ibr::test;
using Catch::Contains;
using nlohmann::json;

TEST_CASE("several open scenes have a view each") {
  if (!canView()) return;
  TemporaryFolder folder;
  fs::copy(tinyScene(), folder / "other", fs::copy_options::recursive);
  const auto begin = parseJson(view({tinyScene(), "--size", "320x240", "--frames", "2"}).out)["documents"][0];
  const json report = whileViewing({tinyScene(), folder / "other", "--size", "320x240"}, [](const std::string&) {
    sleepFor(1);
    hold("w", 0.4);
    pressAll({"ctrl+Next"});
    hold("s", 0.4);
    pressAll({"ctrl+Prior"});
    hold("Right", 0.4);
  });
  REQUIRE(report["documents"].size() == 2);
  const json &first = report["documents"][0], &second = report["documents"][1];
  CHECK_THAT(second["path"].get<std::string>(), Contains("other"));
  CHECK(report["current"] == 1);
  const auto forwards = [&](const json& place) {
    return glm::dot(positionOf(place) - positionOf(begin), rotationOf(begin) * glm::dvec3(0, 0, -1));
  };
  CHECK(forwards(first) < -0.01);
  CHECK(forwards(second) > 0.01);
  CHECK(first["rotation"] == begin["rotation"]);
  CHECK(second["rotation"] != begin["rotation"]);
}

TEST_CASE("closing the window while a scene is read or uploaded is no error") {
  if (!canView()) return;
  TemporaryFolder folder;
  Scene many = loadScene(tinyScene());
  REQUIRE(!many.cells.empty());
  many.cells.resize(300, many.cells[0]);
  saveSceneWithLinks(many, folder / "many");
  Outcome outcome;
  {
    const Hands hands([](const std::string&) {});  // closes the window at once
    outcome = view({folder / "many", "--size", "320x240"});
  }
  INFO(outcome.err);
  CHECK(outcome.code == 0);
  CHECK(parseJson(outcome.out)["warnings"].empty());
}

TEST_CASE("a click on a tab shows its scene") {
  if (!canView()) return;
  TemporaryFolder folder;
  fs::copy(tinyScene(), folder / "other", fs::copy_options::recursive);
  Image8 pixels, before;
  const json report =
      whileViewing({folder / "other", tinyScene(), "--size", "640x480", "--screenshot", folder / "shot.png"},
                   [&](const std::string& window) {
                     sleepFor(1);
                     hold("w", 0.5);
                     before = settledPixels(window);
                     act({"mousemove", "--window", window, "330", "45"});
                     act({"click", "1"});
                     pixels = settledPixels(window);
                   });
  REQUIRE(report["documents"].size() == 2);
  CHECK(report["current"] == 0);
  CHECK(sameBesidePanel(pixels, readImage(folder / "shot.png")));
  CHECK(!sameBesidePanel(before, readImage(folder / "shot.png")));
}

TEST_CASE("scenes are closed by key and by their tab's close button, and free the device's memory") {
  if (!canView()) return;
  TemporaryFolder folder;
  for (const char* name : {"a", "b"}) fs::copy(tinyScene(), folder / name, fs::copy_options::recursive);
  const std::vector<std::string> all{folder / "a", folder / "b", tinyScene(), "--size", "500x400"};
  const json byKey = whileViewing(all, [](const std::string&) {
    sleepFor(1);
    pressAll({"ctrl+Next", "ctrl+w", "ctrl+w"});
  });
  REQUIRE(byKey["documents"].size() == 1);
  CHECK(byKey["onDevice"] == 1);
  const json byCross = whileViewing(all, [](const std::string& w) {
    sleepFor(1);
    // The positions of the close buttons are unknown: a click closes a tab, selects a tab, or does nothing.
    for (int x = 250; x < 400; x += 3) act({"mousemove", "--window", w, std::to_string(x), "45", "click", "1"});
  });
  CHECK(byCross["documents"].size() < 3);
  const json none = whileViewing(all, [](const std::string&) {
    sleepFor(1);
    pressAll({"ctrl+w", "ctrl+w", "ctrl+w", "ctrl+w"});
  });
  CHECK(none["documents"].empty());
  CHECK(none["onDevice"] == 0);
}

TEST_CASE("a folder that cannot be opened is reported, and the window stays open") {
  if (!canView()) return;
  TemporaryFolder folder;
  writeFile(folder / "scene.gltf", "{");
  const auto outcome = view({folder / "none", folder.path(), tinyScene(), "--frames", "2", "--size", "320x240"});
  CHECK(outcome.code == 0);
  const json report = parseJson(outcome.out);
  CHECK(report["documents"].size() == 1);
  CHECK(report["warnings"].size() == 2);
  CHECK_THAT(outcome.err, Contains((folder / "none").string()));
  CHECK(view({folder / "none", "--frames", "2"}).code == 4);
}

TEST_CASE("a folder dropped on the window is opened") {
  if (!canView()) return;
  TemporaryFolder folder;
  fs::copy(tinyScene(), folder / "a scene", fs::copy_options::recursive);
  const json report = whileViewing({"--size", "320x240"}, [&](const std::string& window) {
    dropOnto(window, {folder / "a scene", tinyScene()});
    sleepFor(1.5);
  });
  REQUIRE(report["documents"].size() == 2);
  CHECK(report["documents"][0]["path"] == (folder / "a scene").string());
}

TEST_CASE("a folder is typed, completed and opened by the keyboard alone") {
  if (!canView()) return;
  TemporaryFolder folder;
  for (const char* name : {"the scene", "other"}) fs::copy(tinyScene(), folder / name, fs::copy_options::recursive);
  Image8 pixels;
  const json report = whileViewing(
      {"--size", "640x480", "--no-interface", "--screenshot", folder / "shot.png"}, [&](const std::string& window) {
        const auto write = [](const std::string& text) { act({"type", "--delay", "40", text}); };
        pressAll({"ctrl+o"});
        write((folder / "the").string());
        pressAll({"Tab", "Return"});
        waitForPlace(window);
        pressAll({"ctrl+o", "ctrl+a"});
        write((folder / "none").string());
        pressAll({"Return"});
        pressAll({"ctrl+o", "ctrl+a"});
        write((folder / "other").string());
        pressAll({"Escape", "bracketright"});  // not opened; the view has the keyboard again
        sleepFor(1.2);
        hold("Right", 0.3);
        pixels = settledPixels(window);
      });
  REQUIRE(report["documents"].size() == 1);
  CHECK(report["documents"][0]["path"] == (folder / "the scene/").string());
  REQUIRE(report["warnings"].size() == 1);
  CHECK_THAT(report["warnings"][0].get<std::string>(), Contains((folder / "none").string()));
  const auto begin = parseJson(view({tinyScene(), "--size", "640x480", "--frames", "2"}).out)["documents"][0];
  CHECK(positionOf(report["documents"][0]) != positionOf(begin));
  CHECK(rotationOf(report["documents"][0]) != rotationOf(begin));
  CHECK(report["documents"][0]["settings"] == begin["settings"]);  // typed text has no other effect
  CHECK(sameBesidePanel(pixels, readImage(folder / "shot.png")));
}

TEST_CASE("a scene is built from a folder of photographs in the background") {
  if (!canView()) return;
  TemporaryFolder folder;
  fs::copy(tinySet().photographs, folder / "photos", fs::copy_options::recursive);
  const auto outcome = view({folder / "photos", folder / "photos/", "--size", "320x240", "--frames", "2",
                             "--screenshot", folder / "shot.png"});
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  std::size_t begun = 0;
  const json logged = parseJson(outcome.out)["messages"];
  for (const json& line : logged) {
    const std::string text = line.get<std::string>();
    begun += text.find((folder / "photos").string()) != std::string::npos && text.find("-scene") == std::string::npos;
  }
  CHECK(begun == 1);  // although two builds were requested
  CHECK(fs::exists(folder / "photos-scene/scene.gltf"));
  const json report = parseJson(outcome.out);
  REQUIRE(report["documents"].size() == 1);
  CHECK_THAT(report["documents"][0]["path"].get<std::string>(), Contains("photos-scene"));

  fs::create_directories(folder / "broken/sparse");
  writeFile(folder / "broken/a.jpg", "no picture");
  writeFile(folder / "broken/b.jpg", "no picture");
  writeFile(folder / "broken/sparse/images.txt", "no model");
  const auto broken = view({folder / "broken", tinyScene(), "--size", "320x240", "--frames", "2"});
  CHECK(broken.code == 0);
  CHECK_THAT(jsonLine(parseJson(broken.out)["warnings"]), Contains("broken-scene"));
  CHECK(parseJson(broken.out)["documents"].size() == 1);
}

TEST_CASE("closing the viewer stops a build in the background") {
  if (!canView()) return;
  TemporaryFolder folder;
  fs::copy(tinySet().photographs, folder / "photos", fs::copy_options::recursive);
  // So large that building a scene takes long.
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

TEST_CASE("a job in the background is stopped by the keyboard alone") {
  if (!canView()) return;
  TemporaryFolder folder;
  const json report =
      whileViewing({tinyScene(), "--size", "640x480", "--screenshots", folder / "out"}, [&](const std::string& window) {
        pressAll({"k"});
        hold("w", 6);  // a path that takes long to render
        pressAll({"k", "ctrl+m", "F6", "F6", "Down", "space"});
        settledPixels(window);
      });
  CHECK(fs::exists(folder / "out/path_0001.json"));
  CHECK(!fs::exists(folder / "out/path_0001.mp4"));
  CHECK_THAT(jsonLine(report["messages"]), Contains("path_0001.mp4"));
  CHECK(report["warnings"].empty());
}
