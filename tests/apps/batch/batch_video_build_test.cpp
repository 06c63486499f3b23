// SPDX-License-Identifier: Apache-2.0
// `ibr build` of videos. Needs the programs ffmpeg and ffprobe.
#include <algorithm>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <set>

#include "apps/support/run_program.h"
#include "base/file.h"
#include "ibr/scene.h"
#include "support/contents_below.h"
#include "support/json.h"
#include "support/temporary_folder.h"

namespace fs = std::filesystem;
using namespace ibr;
using Catch::Contains;
using nlohmann::json;
using test::runProgram;

namespace {

// A walk of three seconds, made once; null without ffmpeg.
const fs::path* walk() {
  static const test::TemporaryFolder folder;
  static const bool made = [] {
    if (runProgram({"ffprobe", "-version"}, {.program = "/usr/bin/env"}).code != 0) {
      WARN("ffmpeg is not installed");
      return false;
    }
    const auto outcome = test::runLab({"synth", "walk", "-o", folder / "walk", "--seconds", "3", "--fps", "15",
                                       "--size", "256x144", "--views", "2", "-q"});
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    return true;
  }();
  static const fs::path path = folder / "walk";
  return made ? &path : nullptr;
}

std::vector<std::string> buildWalk(const fs::path& scene, const std::vector<std::string>& more = {}) {
  std::vector<std::string> command{"build", *walk() / "walk.mp4", "--model", *walk() / "transforms.json", "-o", scene};
  command.insert(command.end(), more.begin(), more.end());
  return command;
}

std::size_t frameNumber(const std::string& name) {
  return std::stoul(name.substr(name.rfind('_') + 1));
}

}  // namespace

TEST_CASE("a video is built from sharp frames; a second build chooses and matches nothing again", "[video]") {
  if (!walk()) return;
  const test::TemporaryFolder folder;
  const auto outcome = runProgram(buildWalk(folder / "scene"));
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  CHECK_THAT(outcome.out, Contains("of 45 frames chosen"));
  const Scene scene = loadScene(folder / "scene");
  REQUIRE(scene.nodes.size() >= 3);
  CHECK(scene.nodes.size() < 20);
  CHECK(!scene.cells.empty());
  const auto blurred = test::parseJson(readTextFile(*walk() / "walk.json")).at("blurred").get<std::set<std::size_t>>();
  for (const Node& node : scene.nodes) CHECK_FALSE(blurred.contains(frameNumber(node.name)));
  CHECK(runProgram({"validate", folder / "scene"}).code == 0);
  const auto before = test::contentsBelow(folder / "scene");

  const auto again = runProgram(buildWalk(folder / "scene", {"--json", "-"}));
  REQUIRE(again.code == 0);
  CHECK(again.err.find("choosing frames") == std::string::npos);
  const json report = test::parseJson(again.out);
  for (const json& cell : report.at("cells")) CHECK(cell.at("resumed") == true);
  CHECK((test::contentsBelow(folder / "scene") == before));
}

TEST_CASE("--video-frames sets the number of frames", "[video]") {
  if (!walk()) return;
  const test::TemporaryFolder folder;
  const auto outcome = runProgram(buildWalk(folder / "scene", {"--video-frames", "4", "--dry-run"}));
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  const auto frames = test::contentsBelow(folder / "scene/.photographs/walk");
  const auto count = std::ranges::count_if(frames, [](const auto& file) { return file.first.ends_with(".jpg"); });
  CHECK(count >= 3);
  CHECK(count <= 5);
}

TEST_CASE("a folder of photographs and a video give one scene", "[video]") {
  if (!walk()) return;
  const test::TemporaryFolder folder;
  // Frames of another choice take the part of photographs.
  fs::create_directories(folder / "photographs");
  REQUIRE(runProgram({"-v", "error", "-i", *walk() / "walk.mp4", "-fps_mode", "passthrough", "-vf",
                      "select=eq(n\\,3)+eq(n\\,40)", folder / "photographs/still_%06d.jpg"},
                     {.program = "/usr/bin/ffmpeg"})
              .code == 0);
  json transforms = test::parseJson(readTextFile(*walk() / "transforms.json"));
  json frames = json::array();
  for (const std::size_t number : {std::size_t{3}, std::size_t{40}}) {
    frames.push_back(transforms.at("frames").at(number));
    frames.back()["file_path"] = "photographs/still_00000" + std::to_string(number == 3 ? 1 : 2) + ".jpg";
  }
  for (json frame : transforms.at("frames")) {
    frame["file_path"] = "walk/" + frame.at("file_path").get<std::string>();
    frames.push_back(frame);
  }
  transforms["frames"] = frames;
  writeFile(folder / "transforms.json", test::jsonLine(transforms));
  const auto outcome = runProgram({"build", folder / "photographs", *walk() / "walk.mp4", "--model",
                                   folder / "transforms.json", "-o", folder / "scene"});
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  std::size_t stills = 0, video = 0;
  for (const Node& node : loadScene(folder / "scene").nodes)
    ++(node.name.starts_with("photographs/still_") ? stills : video);
  CHECK(stills == 2);
  CHECK(video >= 3);
}

TEST_CASE("a source that is neither a folder nor a video is named", "[video]") {
  const test::TemporaryFolder folder;
  const auto missing = runProgram({"build", folder / "no.mp4", "-o", folder / "scene"});
  CHECK(missing.code == 2);
  CHECK_THAT(missing.err, Contains("no.mp4"));
  writeFile(folder / "text.mp4", std::string_view("not a video"));
  const auto text = runProgram({"build", folder / "text.mp4", "-o", folder / "scene"});
  CHECK(text.code != 0);
  CHECK_THAT(text.err, Contains("text.mp4"));
}
