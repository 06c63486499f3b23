// SPDX-License-Identifier: Apache-2.0
// Command lines of `ibr optimise` and `ibr build --optimise`.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "apps/support/run_program.h"
#include "apps/support/tiny_scene.h"
#include "base/file.h"
#include "ibr/scene.h"
#include "io/image_file.h"
#include "support/contents_below.h"
#include "support/json.h"
#include "support/temporary_folder.h"

namespace fs = std::filesystem;
using namespace ibr;
using namespace ibr::test;
using Catch::Contains;
using Json = nlohmann::json;

namespace {

bool sameMatches(const Scene& a, const Scene& b) {
  for (std::size_t c = 0; c < a.cells.size(); ++c)
    if (a.cells[c].mesh.match != b.cells[c].mesh.match) return false;
  return a.cells.size() == b.cells.size();
}

}  // namespace

TEST_CASE("ibr optimise writes an improved scene, a table, a report and images") {
  const TemporaryFolder folder;
  const std::string out = folder / "out", pictures = folder / "pictures";
  const Outcome outcome =
      runProgram({"optimise", tinyScene(), "-o", out, "--json", folder / "report.json", "--pictures", pictures});
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  CHECK_THAT(outcome.out, Contains("ECC") && Contains("192x144"));
  CHECK_THAT(outcome.err, Contains("cells") && Contains("drawing"));
  const Json report = parseJson(readTextFile(folder / "report.json"));
  const Scene before = loadScene(tinyScene()), after = loadScene(out);
  REQUIRE(report.at("cells").size() == before.cells.size());
  for (const Json& cell : report["cells"]) {
    CHECK(cell.at("cell") == 0);
    CHECK(cell.at("points") == before.cells[0].mesh.vertexCount());
    CHECK(cell.at("images") == before.cells[0].members.size());
    CHECK(cell.at("finalEcc") >= cell.at("initialEcc"));
    CHECK(cell.at("initialEcc") > 0.5);
    CHECK(cell.at("finalEcc") <= 1.0);
    CHECK(cell.at("initialEccPaper") > 0.5);
    CHECK(cell.at("finalEccPaper") <= 1.0);
    CHECK(cell.at("seconds") > 0);
    CHECK(cell.at("resolution") == Json{192, 144});
    CHECK(cell.at("cycles") >= 1);
    CHECK(cell.at("mutations") > 100);
    CHECK(cell.at("pixels") > cell.at("mutations"));
    CHECK(cell.at("members").size() == 3);
  }
  for (const char* key : {"points", "images", "initialEcc", "finalEcc", "initialEccPaper", "finalEccPaper", "seconds"})
    CHECK(report.at("mean").at(key) == report["cells"][0].at(key));
  CHECK(report.at("method") == "gradient");
  CHECK(report.at("radius") == 5.0);
  CHECK(!sameMatches(before, after));
  CHECK(before.backdrops.size() == after.backdrops.size());
  CHECK(runProgram({"validate", out}).code == 0);
  for (const char* what : {"before", "after"}) {
    const Image8 picture = readImage(fs::path(pictures) / fmt::format("cell000_{}.png", what));
    CHECK(picture.width == 192);
    CHECK(picture.height == 144);
  }
  CHECK(readImage(fs::path(pictures) / "cell000_heat.png").width >= 2 * 192);
  CHECK(readImage(fs::path(pictures) / "cell000_crops.png").height > 100);

  SECTION("the same command gives the same bytes; other seeds and settings give other bytes") {
    REQUIRE(runProgram({"optimise", tinyScene(), "-o", folder / "again", "--threads", "1", "-q"}).code == 0);
    CHECK(contentsBelow(folder / "again") == contentsBelow(out));
    REQUIRE(runProgram({"optimise", tinyScene(), "-o", folder / "seeded", "--seed", "2", "-q"}).code == 0);
    CHECK(!sameMatches(loadScene(folder / "seeded"), after));
    REQUIRE(runProgram({"optimise", tinyScene(), "-o", folder / "small", "--radius", "0.5", "--instances", "8",
                        "--decay", "1", "--threshold", "0.1", "--definition", "concatenated", "--prune", "-q"})
                .code == 0);
    CHECK_THAT(readTextFile(folder / "small/scene.gltf"), Contains("concatenated"));
  }
  SECTION("--insert-points inserts points") {
    const Outcome more = runProgram({"optimise", tinyScene(), "-o", folder / "more", "--insert-points", "--insert-gain",
                                     "0", "--json", folder / "more.json", "--pictures", folder / "grown"});
    INFO(more.err);
    REQUIRE(more.code == 0);
    const Json grown = parseJson(readTextFile(folder / "more.json"));
    CHECK(grown.at("insertPoints") == true);
    CHECK(grown.at("insertGain") == 0.0);
    CHECK(report["cells"][0].at("inserted") == 0);
    const std::size_t inserted = grown["cells"][0].at("inserted");
    CHECK(loadScene(folder / "more").cells[0].mesh.vertexCount() == before.cells[0].mesh.vertexCount() + inserted);
    CHECK(runProgram({"validate", folder / "more"}).code == 0);
    CHECK(fs::exists(folder / "grown/cell000_heat.png"));
  }
  SECTION("build --optimise gives the same scene") {
    const Outcome built = runProgram({"build", tinySet().photographs, "-o", folder / "built", "--optimise"});
    INFO(built.err);
    REQUIRE(built.code == 0);
    CHECK_THAT(built.err, Contains("ECC"));
    CHECK(sameMatches(loadScene(folder / "built"), after));
    auto contents = contentsBelow(folder / "built");
    CHECK(std::erase_if(contents, [](const auto& file) { return file.first.starts_with(".build/"); }) > 0);
    CHECK(contents == contentsBelow(out));
  }
}

TEST_CASE("ibr optimise --cells-only leaves all other cells unchanged") {
  const TemporaryFolder folder;
  makeRow(folder / "row");
  REQUIRE(
      runProgram({"build", folder / "row", "-o", folder / "scene", "--dimension", "1", "--no-backdrops", "-q"}).code ==
      0);
  const Scene before = loadScene(folder / "scene");
  REQUIRE(before.cells.size() >= 3);
  const std::string last = std::to_string(before.cells.size() - 1);
  const Outcome outcome =
      runProgram({"optimise", folder / "scene", "-o", folder / "out", "--cells-only", "1", last, "--json", "-"});
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  const Json report = parseJson(outcome.out);
  REQUIRE(report.at("cells").size() == 2);
  CHECK(report["cells"][0].at("cell") == 1);
  const Scene after = loadScene(folder / "out");
  for (std::size_t c = 0; c < before.cells.size(); ++c) {
    const bool asked = c == 1 || c + 1 == before.cells.size();
    CHECK((before.cells[c].mesh.match == after.cells[c].mesh.match) == !asked);
  }
  const Outcome none = runProgram({"optimise", folder / "scene", "-o", folder / "none", "--cells-only", "99"});
  CHECK(none.code == 3);
  CHECK_THAT(none.err, Contains("99"));
}

TEST_CASE("ibr optimise: Ctrl-C leaves complete files, and the same command resumes") {
  const TemporaryFolder folder;
  makeRow(folder / "row");
  REQUIRE(
      runProgram({"build", folder / "row", "-o", folder / "scene", "--dimension", "1", "--no-backdrops", "-q"}).code ==
      0);
  const std::vector<std::string> line{
      "optimise", folder / "scene", "-o", folder / "out", "--threads",           "1", "--method",
      "cpu",      "--decay",        "1",  "--json",       folder / "report.json"};
  Outcome stopped;
  // On a busy machine the signal may arrive after the end of the program; the test then repeats the attempt.
  const auto oneIsKept = [&](const std::string&) {
    const fs::path kept = folder / "out/.optimise";
    return fs::exists(kept) && !fs::is_empty(kept);
  };
  for (int attempt = 0; attempt < 10 && stopped.code != 130; ++attempt) {
    fs::remove_all(folder / "out");
    stopped = runProgram(line, {.interruptWhen = oneIsKept});
  }
  INFO(stopped.err);
  CHECK(stopped.code == 130);
  CHECK_THAT(stopped.err, Contains("warning:") && Contains("again"));
  CHECK(!fs::exists(folder / "out/scene.gltf"));
  for (const auto& [file, unused] : contentsBelow(folder / "out")) CHECK(file.find(".tmp") == std::string::npos);
  REQUIRE(runProgram(line).code == 0);
  const Json report = parseJson(readTextFile(folder / "report.json"));
  CHECK(report.at("cells")[0].at("resumed") == true);
  REQUIRE(runProgram({"optimise", folder / "scene", "-o", folder / "whole", "--method", "cpu", "--decay", "1", "-q"})
              .code == 0);
  CHECK(contentsBelow(folder / "out") == contentsBelow(folder / "whole"));
}

TEST_CASE("ibr optimise rejects invalid options and paths") {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{{"--method", "magic"},
                                                                                     {"--instances", "1"},
                                                                                     {"--instances", "257"},
                                                                                     {"--radius", "0"},
                                                                                     {"--radius", "65"},
                                                                                     {"--decay", "1.1"},
                                                                                     {"--decay", "0"},
                                                                                     {"--threshold", "-1"},
                                                                                     {"--insert-gain", "2"},
                                                                                     {"--definition", "mine"},
                                                                                     {"--cells-only", "-1"},
                                                                                     {"--cells-only"}}) {
    std::vector<std::string> line{"optimise", tinyScene(), "-o", out};
    line.insert(line.end(), words.begin(), words.end());
    INFO(words[0] << " " << (words.size() > 1 ? words[1] : ""));
    CHECK(runProgram(line).code == 1);
  }
  CHECK(runProgram({"optimise", tinyScene()}).code == 1);
  CHECK(runProgram({"optimise", folder / "none", "-o", out}).code == 2);
  const Outcome itself = runProgram({"optimise", tinyScene(), "-o", tinyScene()});
  CHECK(itself.code == 3);
  CHECK_THAT(itself.err, Contains(tinyScene().string()));
  CHECK(runProgram({"build", tinySet().photographs, "-o", out, "--optimise=magic"}).code == 1);
  CHECK(!fs::exists(out));
  const Outcome help = runProgram({"optimise", "--help-all"});
  CHECK(help.code == 0);
  CHECK_THAT(help.out, Contains("Examples:") && Contains("--pictures") && Contains("--definition"));
}
