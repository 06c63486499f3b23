// SPDX-License-Identifier: Apache-2.0
// `ibr htm render` and `ibr render` of 3D video and of a model, with the validation layer.
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "apps/support/moving_frames.h"
#include "apps/support/run_program.h"
#include "base/file.h"
#include "support/contents_below.h"
#include "support/json.h"
#include "support/temporary_folder.h"

namespace fs = std::filesystem;
using namespace ibr;
using Catch::Contains;
using nlohmann::json;

namespace {

// A video of three frames at ten frames a second, made once.
const fs::path& video() {
  static const test::TemporaryFolder folder;
  static const fs::path made = [] {
    const auto outcome =
        test::runProgram(test::sequenceCommand(test::movingFrames(), folder / "video", {"--fps", "10"}));
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    return folder / "video";
  }();
  return made;
}

// Writes the path of a camera that does not move between two times.
void writePath(const fs::path& file, double fps, double from, double to) {
  json keys = json::array();
  for (const double time : {from, to})
    keys.push_back({{"time", time}, {"position", {0, 1, 2.6}}, {"rotation", {0, 0, 0, 1}}, {"fovY", 0.8}});
  if (from == to) keys.erase(1);
  writeFile(file, test::jsonLine(json{{"version", 1}, {"size", {64, 64}}, {"fps", fps}, {"keys", keys}}));
}

json render(std::vector<std::string> arguments) {
  for (const char* more : {"--json", "-"}) arguments.emplace_back(more);
  const auto outcome = test::runProgram(arguments, {.environment = {"VK_INSTANCE_LAYERS=VK_LAYER_KHRONOS_validation"}});
  INFO(outcome.out << outcome.err);
  CHECK(outcome.err.find("VUID") == std::string::npos);
  REQUIRE(outcome.code == 0);
  return test::parseJson(outcome.out);
}

// Rendered images by name, without their metadata texts, which contain times and settings.
std::map<std::string, std::string> drawnBelow(const fs::path& folder) {
  auto files = test::contentsBelow(folder);
  for (auto& [unused, png] : files)
    for (std::size_t at = 8; at + 12 <= png.size();) {  // after the signature: size, type, data, checksum
      std::size_t size = 12;
      for (int i = 0; i < 4; ++i)
        size += std::size_t(static_cast<unsigned char>(png[at + std::size_t(i)])) << (24 - 8 * i);
      if (png.compare(at + 4, 4, "tEXt") == 0)
        png.erase(at, size);
      else
        at += size;
    }
  return files;
}

std::vector<int> framesOf(const json& report) {
  std::vector<int> frames;
  for (const json& view : report.at("views")) frames.push_back(view.at("frame"));
  return frames;
}

using Frames = std::vector<int>;

}  // namespace

TEST_CASE("an image of 3D video equals the image of its frame's model", "[video]") {
  if (!test::deviceIsThere()) return;
  const test::TemporaryFolder folder;
  writePath(folder / "path.json", 10, 0, 0.4);  // longer than the video, so that it repeats
  const json report = render({"render", video(), "--poses", folder / "path.json", "-o", folder / "played"});
  CHECK(framesOf(report) == Frames{0, 1, 2, 0, 1});
  REQUIRE(report.at("frames").size() == 5);
  for (const json& frame : report.at("frames")) {
    CHECK(frame.at("pictures") == 1);
    for (const char* time : {"loadMs", "uploadMs", "renderMs"}) CHECK(frame.at(time).get<double>() > 0);
    CHECK(frame.at("waitMs").get<double>() >= 0);
  }
  const auto played = drawnBelow(folder / "played");
  REQUIRE(played.size() == 5);
  CHECK(played.at("frame_0000.png") != played.at("frame_0001.png"));
  CHECK(played.at("frame_0000.png") == played.at("frame_0003.png"));

  writePath(folder / "leaps.json", 5, 0, 0.8);  // skips frames in both directions
  CHECK(framesOf(render({"render", video(), "--poses", folder / "leaps.json", "-o", folder / "leapt"})) ==
        Frames{0, 2, 1, 0, 2});
  const auto leapt = drawnBelow(folder / "leapt");
  CHECK(leapt.at("frame_0001.png") == played.at("frame_0002.png"));
  CHECK(leapt.at("frame_0002.png") == played.at("frame_0001.png"));
  CHECK(leapt.at("frame_0003.png") == played.at("frame_0000.png"));

  writePath(folder / "still.json", 1, 0, 0);
  for (const std::string frame : {"0", "1", "2"}) {
    INFO(frame);
    render({"htm", "render", video() / ("frame000" + frame), "--poses", folder / "still.json", "-o", folder / "alone"});
    CHECK(drawnBelow(folder / "alone").at("frame_0000.png") == played.at("frame_000" + frame + ".png"));
    const json sought = render({"htm", "render", video(), "--poses", folder / "still.json", "--time", frame + "00e-3",
                                "-o", folder / "sought"});
    CHECK(framesOf(sought) == Frames{std::stoi(frame)});
    CHECK(sought.at("frames").size() == 1);
    CHECK(drawnBelow(folder / "sought") == drawnBelow(folder / "alone"));
  }
}

TEST_CASE("an image of 3D video is reproduced from its metadata, which include the time", "[video]") {
  if (!test::deviceIsThere()) return;
  const test::TemporaryFolder folder;
  writePath(folder / "path.json", 10, 0, 0.2);
  render({"render", video(), "--poses", folder / "path.json", "--gamma", "20", "-o", folder / "played"});
  const fs::path picture = folder / "played/frame_0002.png";
  const json again = render({"render", video(), "--poses", picture, "--gamma", "20", "-o", folder / "again"});
  CHECK(framesOf(again) == Frames{2});
  CHECK(readFile(folder / "again/frame_0002.png") == readFile(picture));
}

TEST_CASE("poses without times show one frame each", "[video]") {
  if (!test::deviceIsThere()) return;
  const test::TemporaryFolder folder;
  const fs::path poses = test::movingFrames() / "frame0000/sparse";
  const json report = render({"render", video(), "--poses", poses, "-o", folder / "each"});
  CHECK(framesOf(report) == Frames{0, 1, 2, 0, 1, 2, 0, 1});
  const json still = render({"render", video(), "--poses", poses, "--time", "0.1", "-o", folder / "still"});
  CHECK(framesOf(still) == Frames(8, 1));
  const auto each = drawnBelow(folder / "each"), moment = drawnBelow(folder / "still");
  for (const std::string name : {"cam00", "cam02", "cam03"})
    CHECK((each.at(name + ".png") == moment.at(name + ".png")) == false);
  for (const std::string name : {"cam01", "cam04", "cam07"}) CHECK(each.at(name + ".png") == moment.at(name + ".png"));
}

TEST_CASE("smoothed weights continue from frame to frame", "[video]") {
  if (!test::deviceIsThere()) return;
  const test::TemporaryFolder folder;
  // The camera jumps to the other side at once, then does not move.
  json keys = json::array();
  const double half = std::sqrt(0.5);
  keys.push_back({{"time", 0}, {"position", {0, 1, 2.6}}, {"rotation", {0, 0, 0, 1}}, {"fovY", 0.8}});
  keys.push_back({{"time", 0.1}, {"position", {2.6, 1, 0}}, {"rotation", {0, half, 0, half}}, {"fovY", 0.8}});
  writeFile(folder / "path.json",
            test::jsonLine(json{{"version", 1}, {"size", {64, 64}}, {"fps", 10}, {"keys", keys}}));
  const auto pictures = [&](const fs::path& asset, const std::string& smooth) {
    fs::remove_all(folder / "out");
    render({"render", asset, "--poses", folder / "path.json", "--smooth", smooth, "-o", folder / "out"});
    return drawnBelow(folder / "out");
  };
  const auto atOnce = pictures(video(), "0"), slowly = pictures(video(), "5");
  CHECK(slowly.at("frame_0000.png") == atOnce.at("frame_0000.png"));
  CHECK(slowly.at("frame_0001.png") != atOnce.at("frame_0001.png"));
  // A video of two equal frames is treated like a single model, and weights adapt over time.
  fs::copy(video(), folder / "twice", fs::copy_options::recursive);
  writeFile(folder / "twice/sequence.json", R"({"version":1,"fps":10,"frames":["frame0001","frame0001"]})");
  CHECK(pictures(folder / "twice", "5") == pictures(video() / "frame0001", "5"));
}

TEST_CASE("an incomplete 3D video gives an error that names the missing part", "[video]") {
  const test::TemporaryFolder folder;
  writePath(folder / "path.json", 10, 0, 0.2);
  fs::copy(video(), folder / "video", fs::copy_options::recursive);
  const auto refused = [&](int code, const std::string& what) {
    const auto outcome =
        test::runProgram({"render", folder / "video", "--poses", folder / "path.json", "-o", folder / "out"});
    CHECK(outcome.code == code);
    CHECK_THAT(outcome.err, Contains(what));
  };
  fs::rename(folder / "video/frame0000", folder / "video/away");
  refused(2, "video/frame0000");
  fs::rename(folder / "video/away", folder / "video/frame0000");
  writeFile(folder / "video/sequence.json", R"({"version":1,"fps":-1,"frames":["frame0000"]})");
  refused(3, "/fps");
  writeFile(folder / "video/sequence.json", R"({"version":1,"fps":25,"frames":["../video/frame0000"]})");
  CHECK(!fs::exists(folder / "out"));
  fs::remove(folder / "video/sequence.json");
  refused(2, "video");
  if (!test::deviceIsThere()) return;
  // The missing frame is played later, so earlier images exist.
  writeFile(folder / "video/sequence.json", R"({"version":1,"fps":10,"frames":["frame0000","nothing"]})");
  refused(2, "video/nothing");
  CHECK(fs::exists(folder / "out/frame_0000.png"));
}

TEST_CASE("render rejects options of another kind of asset", "[video]") {
  const test::TemporaryFolder folder;
  const auto refused = [&](const fs::path& asset, const std::vector<std::string>& options) {
    std::vector<std::string> arguments{"render", asset.string(), "--path", "auto:2", "-o", folder / "out"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const auto outcome = test::runProgram(arguments);
    INFO(outcome.err);
    CHECK(outcome.code == 1);
    CHECK_THAT(outcome.err, Contains(options[0] + ": "));
  };
  const std::vector<std::vector<std::string>> ofScenes{{"--stereo"},         {"--buffers"},   {"--floor", "1"},
                                                       {"--preset", "fast"}, {"--mute", "1"}, {"--filter", "bicubic"}};
  for (const auto& options : ofScenes) {
    refused(video(), options);
    refused(video() / "frame0000", options);
  }
  refused(video() / "frame0000", {"--time", "0"});
  fs::create_directories(folder / "scene");
  writeFile(folder / "scene/scene.gltf", "");  // the name determines the kind
  for (const auto& options :
       std::vector<std::vector<std::string>>{{"--smooth", "1"}, {"--time", "0"}, {"--gamma", "20"}})
    refused(folder / "scene", options);
}
