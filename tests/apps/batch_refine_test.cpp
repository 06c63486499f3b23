// SPDX-License-Identifier: Apache-2.0
// `ibr synth noise`, `ibr refine`, and builds that refine poses.
#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/file.h"
#include "run_program.h"
#include "support/temporary_folder.h"

using namespace ibr;
using nlohmann::json;
using test::runProgram;

namespace {

json reportOf(const test::Outcome& run) {
  INFO(run.err);
  REQUIRE(run.code == 0);
  return json::parse(run.out.substr(run.out.find("{\n")));
}

// Photographs of one wall of the court: those of others share no point with them.
struct Wall {
  explicit Wall(const test::TemporaryFolder& folder)
      : photographs(folder / "court/images"), exact(folder / "court/sparse"), noisy(folder / "noisy") {
    REQUIRE(runProgram(
                {"synth", "court", "-o", folder / "court", "--photographs", "16", "--views", "0", "--size", "320x240"})
                .code == 0);
    REQUIRE(runProgram(noise(noisy)).code == 0);
  }
  std::vector<std::string> noise(const std::string& to) const {
    return {"synth", "noise", "--model", exact, "--pixels", "2", "--track-pixels", "0.3", "-o", to, "--json", "-"};
  }
  // With noisy poses.
  std::vector<std::string> line(std::vector<std::string> words) const {
    words.insert(words.end(), {"--model", noisy, "--json", "-", "--exclude"});
    for (int i = 4; i < 16; ++i) words.push_back(fmt::format("photo{:04}.jpg", i));
    return words;
  }
  std::string photographs, exact, noisy;
};

}  // namespace

TEST_CASE("noise that is planted into poses is refined away, by builds as by ibr refine") {
  test::TemporaryFolder folder;
  const Wall wall(folder);
  const std::string refined = folder / "refined", scene = folder / "scene";
  const json planted = reportOf(runProgram(wall.noise(folder / "again")));
  CHECK(planted["errors"]["photographs"] == 16);
  CHECK(planted["errors"]["turnPx"] > 2);
  for (const char* file : {"cameras.txt", "images.txt", "points3D.txt"})
    CHECK(readTextFile(folder / "again" / file) == readTextFile(folder / "noisy" / file));

  const json report =
      reportOf(runProgram(wall.line({"refine", wall.photographs, "-o", refined, "--truth", wall.exact})));
  const json &before = report["truth"]["before"], &after = report["truth"]["after"];
  CHECK(before["photographs"] == 4);
  CHECK(before["turnPx"] > 2);
  CHECK(after["photographs"] == 4);
  CHECK(after["turnPx"] < 0.2);
  CHECK(after["shift"] < 0.005);
  CHECK(report["refinement"]["after"]["medianPx"] < 0.1 * report["refinement"]["before"]["medianPx"].get<double>());
  CHECK(report["refinement"]["photographs"].size() == 4);
  CHECK_FALSE(std::filesystem::exists(folder / "refined/images"));
  CHECK_FALSE(std::filesystem::exists(folder / "refined/.build"));

  const json built =
      reportOf(runProgram(wall.line({"build", wall.photographs, "-o", scene, "--refine-poses", "auto"})));
  CHECK(built["refinement"] == report["refinement"]);
  for (const auto& entry : std::filesystem::directory_iterator(scene)) {
    const std::string name = entry.path().filename().string();
    CHECK((name[0] != '.' || name == ".refined"));  // cells of both rounds are gone
  }
  const json asRefined =
      reportOf(runProgram({"build", wall.photographs, "--model", refined, "-o", scene, "--json", "-"}));
  REQUIRE_FALSE(built["cells"].empty());
  REQUIRE(asRefined["cells"].size() == built["cells"].size());
  for (std::size_t c = 0; c < built["cells"].size(); ++c)
    CHECK(asRefined["cells"][c]["ecc"] == built["cells"][c]["ecc"]);
  const json off = reportOf(runProgram(wall.line({"build", wall.photographs, "-o", scene})));
  CHECK_FALSE(off.contains("refinement"));
  CHECK(off["cells"][0]["ecc"] != built["cells"][0]["ecc"]);
  const json same = reportOf(runProgram(
      {"build", wall.photographs, "--model", wall.exact, "-o", scene, "--refine-poses", "auto", "--json", "-"}));
  CHECK_FALSE(same.contains("refinement"));  // exact poses are not estimates
}

TEST_CASE("where photographs are left out, poses are refined once, by all of them") {
  if (!test::deviceIsThere()) return;
  test::TemporaryFolder folder;
  const Wall wall(folder);
  const auto leftOut = [&](const std::string& refine) {
    return reportOf(runProgram(wall.line({"eval", "--leave-one-out", wall.photographs, "--refine-poses", refine,
                                          "--no-backdrops", "--every", "3", "--work", folder / refine})));
  };
  const json off = leftOut("off"), refined = leftOut("auto");
  CHECK_FALSE(off.contains("refinement"));
  CHECK(refined["views"].size() == 2);
  CHECK(refined["refinement"]["photographs"].size() == 4);
  CHECK(refined["mean"]["psnrCovered"] > off["mean"]["psnrCovered"].get<double>() + 5);
}

TEST_CASE("noise is planted into a COLMAP model, and nothing else") {
  test::TemporaryFolder folder;
  const std::string out = folder / "noisy";
  CHECK(runProgram({"synth", "noise", "-o", out}).code == 1);
  CHECK(runProgram({"synth", "planes", "--model", out, "-o", out}).code == 1);
  CHECK(runProgram({"synth", "noise", "--model", folder / "none", "-o", out}).code == 2);
}
