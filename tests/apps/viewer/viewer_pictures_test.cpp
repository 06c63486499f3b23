// SPDX-License-Identifier: Apache-2.0
// Files written by the viewer: screenshots, camera paths, videos. `ibr render` draws the same images.
#include "support/json.h"
#include "viewer_harness.h"

#include <nlohmann/json.hpp>

namespace fs = std::filesystem;
using namespace ibr;
using namespace ibr::test;
using Catch::Contains;
using nlohmann::json;

TEST_CASE("the viewer's screenshot equals the image of ibr render") {
  if (!canView()) return;
  TemporaryFolder folder;
  const fs::path shot = folder / "shot.png";
  const auto outcome =
      view({tinyScene(), "--size", "320x240", "--frames", "3", "--screenshot", shot, "--preset", "accurate"});
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  const json report = parseJson(outcome.out);
  CHECK(report["size"] == json::array({320, 240}));
  const json& place = report["documents"][0];
  writeFile(folder / "path.json", jsonLine(json{{"version", 1},
                                                {"size", report["size"]},
                                                {"fps", 1},
                                                {"keys",
                                                 {{{"time", 0},
                                                   {"position", place["position"]},
                                                   {"rotation", place["rotation"]},
                                                   {"fovY", place["fovY"]}}}}}));
  REQUIRE(runProgram({"render", tinyScene(), "--poses", folder / "path.json", "-o", folder / "rendered", "--preset",
                      "accurate"})
              .code == 0);
  const Image8 seen = readImage(shot), rendered = readImage(folder / "rendered/frame_0000.png");
  CHECK(seen.width == 320);
  CHECK((seen.values == rendered.values));
  CHECK((readFile(shot) == readFile(folder / "rendered/frame_0000.png")));
}

TEST_CASE("a harmonised model's screenshot contains its view, and ibr render reproduces the screenshot") {
  if (!canView()) return;
  TemporaryFolder folder;
  makeModel(folder);
  const auto outcome =
      view({folder / "model", "--size", "200x150", "--frames", "2", "--screenshot", folder / "shot.png"});
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  const auto rendered =
      runProgram({"render", folder / "model", "--poses", folder / "shot.png", "-o", folder / "out", "--json", "-"});
  INFO(rendered.err);
  REQUIRE(rendered.code == 0);
  const std::string file = parseJson(rendered.out)["views"][0]["file"];
  CHECK((readFile(file) == readFile(folder / "shot.png")));
}

TEST_CASE("screenshots with the image graph equal those of ibr render --graph") {
  if (!canView()) return;
  TemporaryFolder folder;
  whileViewing({tinyScene(), "--size", "320x240", "--screenshots", folder.path()}, [](const std::string&) {
    hold("s", 0.6);
    sleepFor(0.8);
    pressAll({"p", "g", "p"});
  });
  const auto redrawn = [&](const char* shot, std::vector<std::string> further) {
    further.insert(further.begin(),
                   {"render", tinyScene(), "--poses", folder / shot, "-o", folder / "again", "--json", "-"});
    const auto outcome = runProgram(further);
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    return readFile(parseJson(outcome.out)["views"][0]["file"].get<std::string>());
  };
  CHECK(bool(redrawn("view_0001.png", {}) == readFile(folder / "view_0001.png")));
  CHECK(bool(redrawn("view_0002.png", {"--graph"}) == readFile(folder / "view_0002.png")));
  CHECK(difference(readImage(folder / "view_0001.png"), readImage(folder / "view_0002.png"), 30).shareAbove > 0.005);
}

TEST_CASE("a view round trips through the clipboard, and ibr render accepts the saved camera path") {
  if (!canView()) return;
  TemporaryFolder folder;
  const auto begin = parseJson(view({tinyScene(), "--size", "320x240", "--frames", "2"}).out)["documents"][0];
  const auto report =
      whileViewing({tinyScene(), "--size", "320x240", "--screenshots", folder.path()}, [](const std::string&) {
        pressAll({"ctrl+c", "k"});
        hold("w", 0.4);
        sleepFor(0.8);
        pressAll({"k", "ctrl+s", "p", "ctrl+v"});
      });
  for (const char* field : {"position", "rotation", "fovY"})  // pasted at the copied pose
    CHECK(report["documents"][0][field] == begin[field]);
  REQUIRE(fs::exists(folder / "path_0001.json"));
  REQUIRE(fs::exists(folder / "view_0001.png"));
  const json path = parseJson(readTextFile(folder / "path_0001.json"));
  REQUIRE(path["keys"].size() == 2);
  CHECK(path["size"] == json::array({320, 240}));
  CHECK(path["keys"][0]["position"] == begin["position"]);
  CHECK(path["keys"][0]["rotation"] == begin["rotation"]);
  CHECK(path["keys"][0]["fovY"] == begin["fovY"]);
  CHECK(path["keys"][1]["position"] != begin["position"]);
  const auto played =
      runProgram({"render", tinyScene(), "--poses", folder / "path_0001.json", "-o", folder / "played", "--json", "-"});
  INFO(played.err);
  REQUIRE(played.code == 0);
  const auto single =
      runProgram({"render", tinyScene(), "--poses", folder / "view_0001.png", "-o", folder / "single", "--json", "-"});
  REQUIRE(single.code == 0);
  const std::string shot = parseJson(single.out)["views"][0]["file"];
  CHECK((readFile(shot) == readFile(folder / "view_0001.png")));
}

TEST_CASE("a camera path becomes a video with the view's settings") {
  if (!canView()) return;
  TemporaryFolder folder;
  const fs::path pictures = folder / "out/path_0001", video = folder / "out/path_0001.mp4";
  const auto framesIn = [&](const json& path) {
    const double seconds = path["keys"].back()["time"].get<double>() - path["keys"][0]["time"].get<double>();
    return std::size_t(std::floor(seconds * path["fps"].get<double>() + 1e-6)) + 1;
  };
  const auto picturesThere = [&] {
    return fs::exists(pictures) ? std::size_t(std::distance(fs::directory_iterator(pictures), {})) : 0;
  };

  SECTION("with ffmpeg") {
    if (!hasFfmpeg()) return;
    const json report = whileViewing({tinyScene(), "--size", "321x240", "--screenshots", folder / "out", "--preset",
                                      "accurate", "--cells", "1", "--blend", "mixed", "--switch", "0"},
                                     [&](const std::string&) {
                                       recordPath();
                                       pressAll({"ctrl+m"});
                                       comes([&] { return fs::exists(video); });
                                     });
    INFO(jsonLine(report["warnings"]));
    CHECK(report["warnings"].empty());
    const json path = parseJson(readTextFile(folder / "out/path_0001.json"));
    CHECK(path["size"] == json::array({321, 240}));
    CHECK(picturesThere() == framesIn(path));
    CHECK((readFile(pictures / "frame_0000.png") == readFile(folder / "out/view_0001.png")));
    REQUIRE(fs::exists(video));
    CHECK(std::system(("test $(ffprobe -v error -count_frames -show_entries stream=nb_read_frames -of csv=p=0 '" +
                       video.string() + "') = " + std::to_string(framesIn(path)))
                          .c_str()) == 0);
    CHECK(path["fps"] == 30);
    CHECK(std::system(
              ("test $(ffprobe -v error -show_entries stream=r_frame_rate -of csv=p=0 '" + video.string() + "') = 30/1")
                  .c_str()) == 0);
  }
  SECTION("without ffmpeg the frames stay, and a message names ffmpeg") {
    const json report =
        whileViewing({tinyScene(), "--size", "320x240", "--screenshots", folder / "out"},
                     [&](const std::string&) {
                       recordPath();
                       pressAll({"ctrl+m"});
                       comes([&] {
                         return fs::exists(folder / "out/path_0001.json") &&
                                picturesThere() == framesIn(parseJson(readTextFile(folder / "out/path_0001.json")));
                       });
                       sleepFor(2);
                     },
                     {"PATH=/nowhere"});
    CHECK(picturesThere() == framesIn(parseJson(readTextFile(folder / "out/path_0001.json"))));
    CHECK(!fs::exists(video));
    CHECK_THAT(jsonLine(report["messages"]), Contains(pictures.string()) && Contains("ffmpeg"));
  }
}

TEST_CASE("a harmonised model's camera path becomes frames with the model's settings") {
  if (!canView()) return;
  TemporaryFolder folder;
  makeModel(folder);
  const fs::path pictures = folder / "out/path_0001";
  const json report = whileViewing(
      {folder / "model", "--size", "640x480", "--screenshots", folder / "out"}, [&](const std::string& window) {
        waitForPlace(window);
        // Settings; the document, two rows of tabs, the method: selects the next one in the list.
        pressAll({"2", "F6", "Down", "Down", "Down", "Down", "space", "Down", "space", "F6"});
        recordPath();
        pressAll({"ctrl+m"});
        comes([&] { return fs::exists(pictures / "frame_0000.png"); });
        comes([&] { return fs::exists(folder / "out/path_0001.mp4"); });
      });
  CHECK(report["warnings"].empty());
  CHECK(report["documents"][0]["settings"]["method"] == "vdtbm");
  REQUIRE(fs::exists(folder / "out/view_0001.png"));
  CHECK((readFile(pictures / "frame_0000.png") == readFile(folder / "out/view_0001.png")));
  CHECK(fs::exists(pictures / "frame_0001.png"));
}

TEST_CASE("a screenshot that cannot be written is reported, and the window stays open") {
  if (!canView()) return;
  TemporaryFolder folder;
  writeFile(folder / "file", "in the way");
  const auto report =
      whileViewing({tinyScene(), "--size", "320x240", "--screenshots", folder / "file/below"}, [](const std::string&) {
        pressAll({"p", "k", "ctrl+s"});
      });
  CHECK(report["documents"].size() == 1);
  CHECK(report["warnings"].size() == 2);
}

TEST_CASE("screenshots go to the user's pictures folder") {
  if (!canView()) return;
  TemporaryFolder home;
  const std::vector<std::string> environment{"HOME=" + home.path().string(), "XDG_CONFIG_HOME="};
  const auto folderToldIn = [&](const RunOptions& options) {
    const std::string help = runProgram({"--help"}, options).out;
    const std::size_t from = help.find("camera paths and videos");
    return help.substr(from, help.find(']', from) - from);
  };
  const RunOptions options{.program = IBR_VIEWER, .environment = environment};
  CHECK_THAT(folderToldIn(options), Contains(fs::current_path().string()));  // the folder Pictures does not exist
  fs::create_directories(home / "Pictures");
  CHECK_THAT(folderToldIn(options), Contains((home / "Pictures/ibr").string()));
  fs::create_directories(home / "Meine Bilder");
  fs::create_directories(home / ".config");
  writeFile(home / ".config/user-dirs.dirs",
            "# comment\nXDG_DESKTOP_DIR=\"$HOME/\"\nXDG_PICTURES_DIR=\"$HOME/Meine Bilder\"\n");
  const auto report = whileViewing(
      {tinyScene(), "--size", "320x240"}, [](const std::string&) { pressAll({"p"}); }, environment);
  CHECK(fs::exists(home / "Meine Bilder/ibr/view_0001.png"));
  CHECK_THAT(jsonLine(report["messages"]), Contains((home / "Meine Bilder/ibr/view_0001.png").string()));
}
