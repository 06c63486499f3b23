// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>

#include "apps/support/run_program.h"
#include "base/file.h"
#include "io/image_file.h"
#include "support/json.h"
#include "support/temporary_folder.h"

namespace fs = std::filesystem;
using namespace ibr;
using Catch::Contains;
using test::runLab;
using test::runProgram;

namespace {

std::map<std::string, std::string> contentsBelow(const fs::path& folder) {
  std::map<std::string, std::string> contents;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) contents[fs::relative(entry.path(), folder).string()] = readTextFile(entry.path());
  return contents;
}

}  // namespace

TEST_CASE("synth writes scenes that every command reads, and truth for eval") {
  for (const std::string kind : {"planes", "room-pano", "room-mixed"}) {
    test::TemporaryFolder folder;
    const std::string scene = folder / "scene";
    const auto made = runLab({"synth", kind, "-o", scene, "--size", kind == "planes" ? "320x240" : "512x256",
                              "--members", "3", "--views", "3", "--json", "-"});
    INFO(kind << ": " << made.err);
    REQUIRE(made.code == 0);
    const auto report = test::parseJson(made.out);
    CHECK(report.at("photographs") == 3);
    CHECK(report.at("views") == 3);
    CHECK(report.at("triangles") > 100);
    CHECK(runProgram({"validate", scene}).code == 0);
    CHECK_THAT(runProgram({"info", scene}).out, Contains("view0"));
    if (!test::deviceIsThere()) continue;
    const auto eval = runProgram({"eval", scene, "--truth", report.at("truth"), "--tiers", "2", "--json", "-"});
    INFO(eval.err);
    REQUIRE(eval.code == 0);
    const auto mean = test::parseJson(eval.out).at("mean");
    CHECK(mean.at("psnrCovered") > 28);
    CHECK(mean.at("coverage") > (kind == "planes" ? 0.6 : kind == "room-mixed" ? 0.5 : 0.9999));
  }
}

TEST_CASE("a synthetic grid is evaluated, walked within a memory budget, and compared in all texture formats") {
  test::TemporaryFolder folder;
  const std::string scene = folder / "scene";
  const auto made = runLab({"synth", "grid", "-o", scene, "--side", "5", "--size", "128x96", "--texture", "bc7",
                            "--views", "2", "--json", "-"});
  INFO(made.err);
  REQUIRE(made.code == 0);
  const auto report = test::parseJson(made.out);
  CHECK(report.at("photographs") == 25);
  CHECK(report.at("cells") == 32);
  CHECK(runProgram({"validate", scene}).code == 0);
  CHECK_THAT(runProgram({"info", scene}).out, Contains("25") && Contains("bc7"));
  if (!test::deviceIsThere()) return;
  const auto eval = runProgram({"eval", scene, "--truth", report.at("truth"), "--tiers", "2", "--json", "-"});
  REQUIRE(eval.code == 0);
  CHECK(test::parseJson(eval.out).at("mean").at("psnrCovered") > 23);  // magnified photographs of 128×96 px

  const auto walked = [&](const std::string& budget) {
    const auto outcome = runProgram(
        {"bench", scene, "--walk", scene + "/walk.json", "--size", "64x40", "--vram-budget", budget, "--json", "-"});
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    const auto walk = test::parseJson(outcome.out).at("walk");
    const auto& peak = walk.at("peak");
    const auto bytes = [&](const char* kind) { return peak.at(kind).get<std::uint64_t>(); };
    CHECK(bytes("positions") + bytes("indices") + bytes("textures") <= walk.at("budget"));
    CHECK(walk.at("frames") > 50);
    CHECK(walk.at("framesWithHoles") == 0);
    CHECK(walk.at("failed") == 0);
    return walk;
  };
  CHECK(walked("1G").at("streamedBytes") == 0);  // the whole scene fits
  CHECK(walked("300K").at("streamedBytes") > 0);
  CHECK(runProgram({"bench", scene, "--walk", scene + "/walk.json", "--vram-budget", "1K"}).code == 4);

  const auto outcome =
      runProgram({"bench", scene, "--formats", "--size", "64x40", "--views", "1", "--repeat", "1", "--json", "-"});
  INFO(outcome.err);
  if (std::getenv("IBR_DISABLE_FEATURES") && outcome.code == 5) {
    CHECK_THAT(outcome.err, Catch::Contains("block"));
    return;
  }
  REQUIRE(outcome.code == 0);
  const auto formats = test::parseJson(outcome.out).at("formats");
  REQUIRE(formats.size() == 7);
  CHECK(formats[0].at("ratio") == 1);
  CHECK(formats[0].at("textureBytes") > formats[2].at("textureBytes"));
  CHECK(formats[2].at("textureBytes") > formats[4].at("textureBytes"));
  CHECK(formats[2].at("psnr") > formats[4].at("psnr"));
}

TEST_CASE("synth writes equal files for equal seeds, and other files for another seed") {
  test::TemporaryFolder folder;
  const auto synth = [&](const std::string& name, const std::string& seed) {
    REQUIRE(runLab({"synth", "room-pano", "-o", folder / name, "--size", "64x32", "--members", "2", "--views", "1",
                    "--seed", seed, "-q"})
                .code == 0);
    return contentsBelow(folder / name);
  };
  const auto first = synth("a", "5"), second = synth("b", "5"), other = synth("c", "6");
  CHECK(first == second);
  CHECK(first.at("images/view0.png") != other.at("images/view0.png"));
  CHECK(first.at("truth/sparse/images.txt") != other.at("truth/sparse/images.txt"));
}

TEST_CASE("synth rejects unknown kinds and invalid options") {
  CHECK(runLab({"synth"}).code == 1);
  CHECK(runLab({"synth", "planes"}).code == 1);
  const auto unknown = runLab({"synth", "castle", "-o", "x"});
  CHECK(unknown.code == 1);
  CHECK_THAT(unknown.err, Contains("castle") && Contains("room-pano"));
  CHECK(runLab({"synth", "planes", "-o", "x", "--members", "5"}).code == 1);
  CHECK(runLab({"synth", "planes", "-o", "/proc/none/scene", "--size", "32x24", "--views", "0"}).code == 2);
}

TEST_CASE("build reads panoramas.json, and a single panorama makes no cell") {
  test::TemporaryFolder folder;
  fs::create_directories(folder / "images");
  writeImage(folder / "images/a.png", Image8(64, 32, 3, 90));
  writeFile(folder / "panoramas.json", std::string_view(R"({"width": 64, "height": 32, "panoramas": [
    {"name": "images/a.png", "position": [0, 0, 0], "R_world_to_camera": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]}]})"));
  const std::string json = folder / "panoramas.json";
  const auto build = runProgram({"build", folder.path(), "--panoramas", json, "-o", folder / "scene"});
  CHECK(build.code == 0);
  CHECK_THAT(build.out, Contains("images/a.png"));
  CHECK(runProgram({"build", folder.path(), "--panoramas", json, "--model", folder.path(), "-o", folder / "s"}).code ==
        1);
  writeFile(folder / "panoramas.json", std::string_view("{}"));
  CHECK(runProgram({"build", folder.path(), "--panoramas", json, "-o", folder / "scene"}).code == 3);
  CHECK(runProgram({"build", folder.path(), "--panoramas", folder / "none.json", "-o", folder / "scene"}).code == 2);
}

TEST_CASE("synth moving writes frames in the layout that ibr htm build reads") {
  const test::TemporaryFolder folder;
  const std::vector<std::string> arguments{
      "synth", "moving", "-o", (folder / "a").string(), "--frames", "2", "--views", "1", "--size", "48x40", "-q"};
  REQUIRE(runLab(arguments).code == 0);
  const auto files = contentsBelow(folder / "a");
  CHECK(files.size() == 2 * (2 + 3 + 2 * 8 + 3 + 2));
  for (const std::string frame : {"frame0000/", "frame0001/"}) {
    for (const std::string name : {"mesh.ply", "mesh_exact.ply", "sparse/images.txt", "images/cam07.png",
                                   "masks/cam00.png", "truth/images/truth00.png", "truth/sparse/cameras.txt"})
      CHECK(files.contains(frame + name));
    const Image8 mask = readImage(folder / "a" / frame / "masks/cam03.png");
    CHECK(mask.width == 48);
  }
  CHECK(files.at("frame0000/mesh_exact.ply") != files.at("frame0001/mesh_exact.ply"));
  CHECK(files.at("frame0000/images/cam02.png") != files.at("frame0001/images/cam02.png"));
  CHECK(files.at("frame0000/sparse/images.txt") == files.at("frame0001/sparse/images.txt"));
}

TEST_CASE("synth court writes photographs from which build makes a scene") {
  const test::TemporaryFolder folder;
  const std::string court = folder / "court";
  const auto made =
      runLab({"synth", "court", "-o", court, "--photographs", "6", "--views", "1", "--size", "160x120", "--json", "-"});
  INFO(made.err);
  REQUIRE(made.code == 0);
  const auto report = test::parseJson(made.out);
  CHECK(report.at("photographs") == 6);
  CHECK(report.at("tracks") > 100);
  CHECK(readImage(folder / "court/truth/images/truth00.png").width == 160);
  const auto built = runProgram(
      {"build", court + "/images", "-o", folder / "scene", "--tracks", "model", "--no-backdrops", "-q", "--json", "-"});
  INFO(built.err);
  REQUIRE(built.code == 0);
  const auto scene = test::parseJson(built.out);
  CHECK(scene.at("dropped").empty());
  CHECK(scene.at("cells").size() >= 1);
  const auto before = contentsBelow(court);
  REQUIRE(runLab({"synth", "court", "-o", court, "--photographs", "6", "--views", "1", "--size", "160x120", "-q",
                  "--threads", "1"})
              .code == 0);
  CHECK((contentsBelow(court) == before));
}
