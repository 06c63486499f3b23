// SPDX-License-Identifier: Apache-2.0
// `ibr eval --leave-one-out`, and the baselines of `ibr eval`.
#include <catch2/catch.hpp>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <nlohmann/json.hpp>

#include "apps/support/run_program.h"
#include "apps/support/tiny_scene.h"
#include "base/file.h"
#include "io/image_file.h"
#include "support/json.h"
#include "support/temporary_folder.h"
#include "unit/io/unusual_files.h"

namespace fs = std::filesystem;
using namespace ibr;
using Catch::Contains;
using nlohmann::json;
using test::runProgram;

namespace {

json withoutTimes(json report) {
  for (auto& [key, value] : report.items()) {
    if (value.is_structured()) value = withoutTimes(value);
    if (key == "milliseconds") value = nullptr;
  }
  return report;
}

}  // namespace

TEST_CASE("leave-one-out scores equal those of a build that excludes the photograph") {
  if (!test::deviceIsThere()) return;
  test::TemporaryFolder folder;
  const fs::path photographs = folder / "row", work = folder / "work", pictures = folder / "left-out";
  test::makeRow(photographs);
  // With the homographic matcher cells are shared; with member depth, cells depend on all photographs.
  const std::vector<std::string> matcher{"--matcher", "homographic"};
  std::vector<std::string> line{"eval", "--leave-one-out", photographs, "--every", "2", "--work", work,
                                "-o",   pictures,          "--json",    "-"};
  line.insert(line.end(), matcher.begin(), matcher.end());
  const auto outcome = runProgram(line);
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  const json report = test::parseJson(outcome.out);
  REQUIRE(report.at("views").size() == 3);
  // Cells 1-2, 2-3, 3-4; 0-1, 1-3, 3-4; 0-1, 1-2, 2-3: five different cells, nine uses.
  CHECK(report.at("cellsMatched") == 5);
  CHECK(report.at("cellsShared") == 4);
  CHECK(report.at("mean").at("psnr") > 20);
  for (const json& view : report["views"]) {
    const std::string name = view.at("name");
    INFO(name);
    const fs::path scene = folder / ("without-" + name), compared = folder / ("compared-" + name);
    std::vector<std::string> build{"build", photographs, "-o", scene, "--exclude", name, "-q"};
    build.insert(build.end(), matcher.begin(), matcher.end());
    REQUIRE(runProgram(build).code == 0);
    const auto eval =
        runProgram({"eval", scene, "--truth", photographs, "--views", name, "-o", compared, "--json", "-"});
    INFO(eval.err);
    REQUIRE(eval.code == 0);
    CHECK(withoutTimes(test::parseJson(eval.out)["views"][0]) == withoutTimes(view));
    CHECK(readTextFile(compared / name) == readTextFile(pictures / name));
  }

  SECTION("a second run reuses all results") {
    const auto again = runProgram(line);
    REQUIRE(again.code == 0);
    const json second = test::parseJson(again.out);
    CHECK(second.at("views") == report["views"]);
    CHECK(second.at("cellsMatched") == 0);
    CHECK(second.at("cellsShared") == 0);
  }
  SECTION("another optimiser gives other scores") {
    std::vector<double> psnr;
    for (const char* method : {"--optimise", "--optimise=cpu"}) {
      std::vector<std::string> words = line;
      words.emplace_back(method);
      const auto optimised = runProgram(words);
      INFO(optimised.err);
      REQUIRE(optimised.code == 0);
      psnr.push_back(test::parseJson(optimised.out).at("mean").at("psnr"));
    }
    CHECK(psnr[0] != report.at("mean").at("psnr"));
    CHECK(psnr[1] != report.at("mean").at("psnr"));
    CHECK(psnr[0] != psnr[1]);
  }
  SECTION("other settings and a deleted image reuse the cached cells") {
    fs::remove(pictures / "row2.png");
    const json repaired = test::parseJson(runProgram(line).out);
    CHECK(fs::exists(pictures / "row2.png"));
    CHECK(withoutTimes(repaired["views"]) == withoutTimes(report["views"]));
    CHECK(repaired.at("cellsMatched") == 0);
    CHECK(repaired.at("cellsShared") == 3);
    auto other = line;
    other.insert(other.end(), {"--tiers", "0"});
    const json tier0 = test::parseJson(runProgram(other).out);
    CHECK(tier0.at("cellsMatched") == 0);
    CHECK(tier0.at("mean").at("coverage") < report["mean"]["coverage"]);
  }
}

TEST_CASE("leave-one-out resumes after an interrupt") {
  if (!test::deviceIsThere()) return;
  test::TemporaryFolder folder;
  test::makeRow(folder / "row");
  const std::vector<std::string> line{
      "eval", "--leave-one-out", folder / "row", "--every", "2", "--work", folder / "w", "--tiers", "0", "--json", "-"};
  const fs::path finished = folder / "w/views";  // one file per finished view
  const auto stopped = runProgram(
      line, {.interruptWhen = [&](const std::string&) { return fs::exists(finished) && !fs::is_empty(finished); }});
  INFO(stopped.err);
  REQUIRE(stopped.code == 130);
  CHECK_THAT(stopped.err, Contains("--leave-one-out") && Contains("again"));
  const auto outcome = runProgram(line);
  REQUIRE(outcome.code == 0);
  const json report = test::parseJson(outcome.out);
  CHECK(report.at("views").size() == 3);
  CHECK(report.at("cellsMatched") < 9);  // no cell is shared, because member depth depends on all remaining photographs
}

TEST_CASE("a photograph without which no cell is left is reported, and the others are scored") {
  if (!test::deviceIsThere()) return;
  test::TemporaryFolder folder;
  const fs::path photographs = folder / "photographs", images = photographs / "sparse/images.txt";
  test::makeRow(photographs);
  // One photograph gets a pose with the opposite direction.
  std::string text = readTextFile(images);
  const std::size_t end = text.find(" row2.png"), begin = text.rfind('\n', end) + 1;
  text.replace(begin, end - begin, "3 0 0 0 1 0.6 0 0 3");
  writeFile(images, text);
  const auto leaveOut = [&](std::vector<std::string> excluded) {
    std::vector<std::string> line{"eval",   "--leave-one-out",      photographs,
                                  "--json", folder / "report.json", "--exclude"};
    line.insert(line.end(), excluded.begin(), excluded.end());
    const auto outcome = runProgram(line);
    INFO(outcome.err);
    CHECK_THAT(outcome.err, Contains("row0.png") && Contains("cells"));
    CHECK(outcome.code == (excluded.size() == 2 ? 0 : 3));
    return test::parseJson(readTextFile(folder / "report.json"));
  };
  const json report = leaveOut({"row3.png", "row4.png"});
  REQUIRE(report.at("views").size() == 3);
  CHECK_THAT(report["views"][0].at("failure").get<std::string>(), Contains("cells"));
  CHECK(report["views"][0].at("psnr").is_null());
  CHECK(report["views"][1].contains("failure"));
  CHECK(!report["views"][2].contains("failure"));
  CHECK(report["views"][2].at("psnr").is_number());
  CHECK(report.at("mean").at("psnr") == report["views"][2]["psnr"]);
  CHECK(leaveOut({"row2.png", "row3.png", "row4.png"}).at("mean").at("psnr").is_null());
}

TEST_CASE("leave-one-out rejects panoramas, unknown names and missing poses") {
  test::TemporaryFolder folder;
  test::makeRow(folder / "row");
  const auto unknown = runProgram({"eval", "--leave-one-out", folder / "row", "--views", "none.png"});
  CHECK(unknown.code == 3);
  CHECK_THAT(unknown.err, Contains("none.png"));
  CHECK(runProgram({"eval", "--leave-one-out", folder / "nowhere"}).code == 2);
  fs::create_directories(folder / "alone/photographs");
  const auto unposed = runProgram({"eval", "--leave-one-out", folder / "alone/photographs"});
  CHECK(unposed.code == 3);
  CHECK_THAT(unposed.err, Contains("photographs") && Contains("--model"));

  fs::create_directories(folder / "around/sparse");
  writeFile(folder / "around/sparse/cameras.txt", std::string_view("1 EQUIRECTANGULAR 64 32 64 32\n"));
  writeFile(folder / "around/sparse/images.txt",
            std::string_view("1 1 0 0 0 0 0 0 1 a.png\n\n2 1 0 0 0 1 0 0 1 b.png\n\n"));
  writeFile(folder / "around/sparse/points3D.txt", std::string_view(""));
  for (const char* name : {"a.png", "b.png"}) writeImage(folder / "around" / name, Image8(64, 32, 3, 90));
  const auto panorama = runProgram({"eval", "--leave-one-out", folder / "around"});
  CHECK(panorama.code == 5);
  CHECK_THAT(panorama.err, Contains("a.png") && Contains("panorama"));
}

TEST_CASE("baselines are scored, and return photographs at their own poses") {
  if (!test::deviceIsThere()) return;
  test::TemporaryFolder folder;
  const auto evaluate = [&](const fs::path& truth) {
    const auto outcome =
        runProgram({"eval", test::tinyScene(), "--truth", truth, "--composition", "cells", "--baselines", "--fit-gain",
                    "-o", folder / "out", "--json", folder / "report.json"});
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    CHECK_THAT(outcome.out, Contains("lumigraph") && Contains("gain"));
    return test::parseJson(readTextFile(folder / "report.json"));
  };
  const auto isPhotograph = [](const json& scores) { return scores.at("psnr").is_null() || scores.at("psnr") > 45; };
  const json atPhotographs = evaluate(test::tinySet().photographs);
  for (const json& view : atPhotographs.at("views"))
    for (const char* name : {"nearest", "lumigraph", "gathered"}) CHECK(isPhotograph(view.at("baselines").at(name)));

  const json between = evaluate(test::tinySet().truth).at("views").at(0);
  const json& others = between.at("baselines");
  REQUIRE(others.size() == 6);
  for (const json& scores : others) {
    for (const char* key : {"psnr", "ssim", "flip", "coverage", "psnrCovered", "psnrGain", "psnrCoveredGain"})
      CHECK(scores.at(key).is_number());
    CHECK(scores["psnrGain"] > double(scores["psnr"]) - 0.3);  // the gain is optimal in linear light, not in decibels
  }
  CHECK(between.at("psnrGain") > 0);
  // The paper's draw order gives the same occlusion and blending.
  CHECK(double(others["paperOrder"]["psnr"]) == Approx(double(between["psnr"])).margin(0.3));
  CHECK(others["paper"]["coverage"] <= between["coverage"]);
  CHECK(between["psnr"] > others["nearest"]["psnr"]);
  CHECK(others["gathered"]["psnr"] > others["nearest"]["psnr"]);
  for (const char* name : {"nearest", "lumigraph", "crossFade", "paper", "paperOrder", "gathered"})
    CHECK(fs::exists(folder / "out" / name / "between.png"));
}

TEST_CASE("the reference gather agrees with the device's and rejects scenes without depth") {
  if (!test::deviceIsThere()) return;
  test::TemporaryFolder folder;
  const auto evaluate = [&](const fs::path& scene) {
    return runProgram({"eval", scene, "--truth", test::tinySet().truth, "--composition", "gathered", "--vote-scale",
                       "1", "--tiers", "3", "--baselines", "gathered", "--json", folder / "report.json"});
  };
  const auto outcome = evaluate(test::tinyScene());
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  const json gathered = test::parseJson(readTextFile(folder / "report.json")).at("views").at(0);
  const json& composed = gathered["baselines"]["gathered"];
  CHECK(composed["coverage"] == 1);  // holes are filled, as on a device
  CHECK(double(composed["psnr"]) == Approx(double(gathered["psnr"])).margin(0.3));

  const fs::path bare = folder / "bare";
  const auto built = runProgram({"build", test::tinySet().photographs, "--no-backdrops", "-o", bare, "-q"});
  INFO(built.err);
  REQUIRE(built.code == 0);
  const auto refused = evaluate(bare);
  CHECK(refused.code == 3);
  CHECK_THAT(refused.err, Contains("bare") && Contains("depth") && Contains("gathered"));
}

namespace {

// Writes a 16-bit depth PNG with the value 400 everywhere.
void writeEvenDepth(const fs::path& file, int width, int height) {
  test::Bytes row;
  for (int x = 0; x < width; ++x) row.insert(row.end(), {400 / 256, 400 % 256});
  constexpr int kGrey = 0;  // PNG_COLOR_TYPE_GRAY
  const test::Bytes png = test::makePng(width, height, kGrey, 16, std::vector<test::Bytes>(std::size_t(height), row));
  writeFile(file, std::string_view(reinterpret_cast<const char*>(png.data()), png.size()));
}

}  // namespace

TEST_CASE("eval reports named baselines, torn tiles, guessed pixels and depth against the truth") {
  if (!test::deviceIsThere()) return;
  test::TemporaryFolder folder;
  const Image8 truth = readImage(test::tinySet().truth / "images/between.png");
  const fs::path depth = folder / "depth";
  fs::create_directories(depth);
  writeEvenDepth(depth / "between.png", truth.width, truth.height);
  const auto outcome =
      runProgram({"eval", test::tinyScene(), "--truth", test::tinySet().truth, "--guessed", "--truth-depth", depth,
                  "--depth-unit", "0.01", "--json", folder / "report.json", "--baselines", "gathered"});
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  const json view = test::parseJson(readTextFile(folder / "report.json")).at("views").at(0);
  REQUIRE(view.at("baselines").size() == 1);
  for (const json& scores : {view, view["baselines"]["gathered"]}) {
    for (const char* key : {"tornTiles", "guessed", "rightDepth", "tooFar", "tooNear"}) {
      CHECK(scores.at(key) >= 0);
      CHECK(scores.at(key) <= 1);
    }
    CHECK(double(scores["rightDepth"]) + double(scores["tooFar"]) + double(scores["tooNear"]) <= 1.0001);
    CHECK(scores.at("worstTile").at("meanSquared") >= 0);
  }

  const auto unknown =
      runProgram({"eval", test::tinyScene(), "--truth", test::tinySet().truth, "--baselines", "magic"});
  CHECK(unknown.code == 1);
  CHECK_THAT(unknown.err, Contains("magic") && Contains("lumigraph"));
  writeEvenDepth(depth / "between.png", 8, 8);
  const auto small = runProgram({"eval", test::tinyScene(), "--truth", test::tinySet().truth, "--truth-depth", depth});
  CHECK(small.code == 3);
  CHECK_THAT(small.err, Contains("between.png"));
}
