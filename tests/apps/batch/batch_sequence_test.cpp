// SPDX-License-Identifier: Apache-2.0
// `ibr htm sequence` on a small moving figure.
#include <catch2/catch.hpp>
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

// Files below a folder without build.json, whose times differ between equal runs.
std::map<std::string, std::string> modelsBelow(const fs::path& folder) {
  std::map<std::string, std::string> files = test::contentsBelow(folder);
  std::erase_if(files, [](const auto& file) { return file.first.ends_with("build.json"); });
  return files;
}

std::vector<bool> keptOf(const test::Outcome& outcome) {
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  std::vector<bool> kept;
  const json report = test::parseJson(outcome.out);
  for (const json& frame : report.at("frames")) kept.push_back(frame.at("cached"));
  return kept;
}

using Kept = std::vector<bool>;

}  // namespace

TEST_CASE("htm sequence builds missing frames and keeps the others", "[sequence]") {
  const test::TemporaryFolder folder;
  fs::copy(test::movingFrames(), folder / "frames", fs::copy_options::recursive);
  const auto build = [&](const std::vector<std::string>& options = {}) {
    return keptOf(test::runProgram(test::sequenceCommand(folder / "frames", folder / "out", options)));
  };
  CHECK(build({"--fps", "10"}) == Kept{false, false, false});
  const auto made = modelsBelow(folder / "out");
  const json index = test::parseJson(made.at("sequence.json"));
  CHECK(index.at("fps") == 10);
  CHECK(index.at("frames") == json{"frame0000", "frame0001", "frame0002"});
  CHECK(test::runProgram({"validate", folder / "out"}).code == 0);

  CHECK(build({"--fps", "10"}) == Kept{true, true, true});
  CHECK(modelsBelow(folder / "out") == made);

  const fs::path picture = folder / "frames/frame0001/images/cam02.png";
  writeFile(picture, readFile(folder / "frames/frame0001/images/cam03.png"));
  CHECK(build() == Kept{true, false, true});
  const auto changed = modelsBelow(folder / "out");
  CHECK(changed.at("frame0001/images/cam02.png") != made.at("frame0001/images/cam02.png"));
  CHECK(test::parseJson(changed.at("sequence.json")).at("fps") == 25);

  for (const auto& entry : fs::directory_iterator(folder / "out/frame0002/meshes")) fs::resize_file(entry.path(), 10);
  fs::remove(folder / "out/frame0000/build.json");
  CHECK(build() == Kept{false, true, false});
  CHECK(modelsBelow(folder / "out") == changed);

  fs::remove_all(folder / "frames/frame0001");
  CHECK(build() == Kept{true, true});
  CHECK(build({"--soft", "3", "--exclude", "cam04.png"}) == Kept{false, false});
}

TEST_CASE("htm sequence resumes after an interrupt", "[sequence]") {
  const test::TemporaryFolder folder;
  const auto command = test::sequenceCommand(test::movingFrames(), folder / "stopped");
  const auto stopped = test::runProgram(
      command, {.interruptWhen = [](const std::string& err) { return err.find("frame0000: ") != std::string::npos; }});
  CHECK(stopped.code == 130);
  CHECK_THAT(stopped.err, Contains("again"));
  for (const auto& entry : fs::directory_iterator(folder / "stopped")) {
    INFO(entry.path());
    CHECK(entry.path().filename().string().starts_with("frame"));  // no sequence index, no partial frame
    CHECK(test::runProgram({"validate", entry.path()}).code == 0);
  }
  fs::create_directories(folder / "stopped/.frame0001.part/images");  // partial frame of a killed program
  writeFile(folder / "stopped/.frame0001.part/images/old.png", "");
  const Kept kept = keptOf(test::runProgram(command));
  CHECK(kept.front());
  CHECK_FALSE(kept.back());
  CHECK(keptOf(test::runProgram(test::sequenceCommand(test::movingFrames(), folder / "whole"))) ==
        Kept{false, false, false});
  CHECK(modelsBelow(folder / "stopped") == modelsBelow(folder / "whole"));
}

TEST_CASE("htm sequence names the frame and the file of an error", "[sequence]") {
  const test::TemporaryFolder folder;
  fs::copy(test::movingFrames(), folder / "frames", fs::copy_options::recursive);
  const fs::path frame = folder / "frames/frame0001";
  const auto refused = [&](int code, const std::vector<std::string>& words) {
    const auto outcome = test::runProgram(test::sequenceCommand(folder / "frames", folder / "out"));
    CHECK(outcome.code == code);
    for (const std::string& word : words) CHECK_THAT(outcome.err, Contains(word));
    CHECK(!fs::exists(folder / "out/sequence.json"));
  };
  const auto without = [&](const char* name, int code, const std::vector<std::string>& words) {
    fs::rename(frame / name, folder / "away");
    refused(code, words);
    CHECK(!fs::exists(folder / "out"));  // before any work
    fs::rename(folder / "away", frame / name);
  };
  without("mesh.ply", 2, {"frame0001", "mesh.ply"});
  without("sparse", 2, {"frame0001/sparse", "COLMAP"});
  without("images", 2, {"frame0001/images"});
  writeFile(frame / "mesh.obj", "");
  refused(3, {"frame0001/mesh.obj", "mesh.ply"});
  fs::remove(frame / "mesh.obj");

  const auto mesh = readFile(frame / "mesh.ply");
  writeFile(frame / "mesh.ply", "ply\n");
  refused(3, {"frame frame0001", (frame / "mesh.ply").string()});
  CHECK(test::runProgram({"validate", folder / "out/frame0000"}).code == 0);
  CHECK(!fs::exists(folder / "out/frame0001"));
  writeFile(frame / "mesh.ply", mesh);
  fs::create_directories(folder / "out/frame0001/something else");
  refused(3, {"out/frame0001", "harmonised"});
  CHECK(fs::exists(folder / "out/frame0001/something else"));

  CHECK(test::runProgram({"htm", "sequence", folder / "nowhere", "-o", folder / "out"}).code == 2);
  fs::create_directories(folder / "empty/.hidden");
  CHECK(test::runProgram({"htm", "sequence", folder / "empty", "-o", folder / "out"}).code == 3);
  const auto inside = test::runProgram({"htm", "sequence", folder / "frames", "-o", folder / "frames/out"});
  CHECK(inside.code == 3);
  CHECK_THAT(inside.err, Contains((folder / "frames/out").string()));
  CHECK(test::runProgram({"htm", "sequence", folder / "frames", "-o", folder / "out", "--fps", "0"}).code == 1);
}
