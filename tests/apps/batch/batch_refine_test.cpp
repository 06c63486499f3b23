// SPDX-License-Identifier: Apache-2.0
// `ibr-lab synth noise`, `ibr refine`, and builds that refine poses.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/support/run_program.h"
#include "base/file.h"
#include "ibr/image.h"
#include "io/image_file.h"
#include "support/json.h"
#include "support/temporary_folder.h"

using namespace ibr;
using nlohmann::json;
using test::runLab;
using test::runProgram;

namespace {

json reportOf(const test::Outcome& run) {
  INFO(run.err);
  REQUIRE(run.code == 0);
  return test::parseJson(run.out.substr(run.out.find("{\n")));
}

// Photographs of one wall of the synthetic scene "court". Photographs of other walls share no point with them.
struct Wall {
  explicit Wall(const test::TemporaryFolder& folder)
      : photographs(folder / "court/images"), exact(folder / "court/sparse"), noisy(folder / "noisy") {
    REQUIRE(
        runLab({"synth", "court", "-o", folder / "court", "--photographs", "16", "--views", "0", "--size", "320x240"})
            .code == 0);
    REQUIRE(runLab(noise(noisy)).code == 0);
  }
  std::vector<std::string> noise(const std::string& to) const {
    return {"synth", "noise", "--model", exact, "--pixels", "2", "--track-pixels", "0.3", "-o", to, "--json", "-"};
  }
  // Command line that uses the noisy poses.
  std::vector<std::string> line(std::vector<std::string> words) const {
    words.insert(words.end(), {"--model", noisy, "--json", "-", "--exclude"});
    for (int i = 4; i < 16; ++i) words.push_back(fmt::format("photo{:04}.jpg", i));
    return words;
  }
  std::string photographs, exact, noisy;
};

}  // namespace

TEST_CASE("ibr refine and build --refine-poses remove noise from poses") {
  test::TemporaryFolder folder;
  const Wall wall(folder);
  const std::string refined = folder / "refined", scene = folder / "scene";
  const json planted = reportOf(runLab(wall.noise(folder / "again")));
  CHECK(planted["errors"]["photographs"] == 16);
  CHECK(planted["errors"]["rotationPx"] > 2);
  for (const char* file : {"cameras.txt", "images.txt", "points3D.txt"})
    CHECK(readTextFile(folder / "again" / file) == readTextFile(folder / "noisy" / file));

  const json report =
      reportOf(runProgram(wall.line({"refine", wall.photographs, "-o", refined, "--truth", wall.exact})));
  const json &before = report["truth"]["before"], &after = report["truth"]["after"];
  CHECK(before["photographs"] == 4);
  CHECK(before["rotationPx"] > 2);
  CHECK(after["photographs"] == 4);
  CHECK(after["rotationPx"] < 0.2);
  CHECK(after["shift"] < 0.005);
  CHECK(report["refinement"]["after"]["medianPx"] < 0.1 * report["refinement"]["before"]["medianPx"].get<double>());
  CHECK(report["refinement"]["photographs"].size() == 4);
  CHECK_FALSE(std::filesystem::exists(folder / "refined/images"));
  CHECK_FALSE(std::filesystem::exists(folder / "refined/.build"));

  const json built = reportOf(runProgram(wall.line({"build", wall.photographs, "-o", scene, "--refine-poses", "on"})));
  CHECK(built["refinement"] == report["refinement"]);
  for (const auto& entry : std::filesystem::directory_iterator(scene)) {
    const std::string name = entry.path().filename().string();
    CHECK((name[0] != '.' || name == ".refined" || name == ".build"));  // cached cells of both rounds are deleted
  }
  const json asRefined =
      reportOf(runProgram({"build", wall.photographs, "--model", refined, "-o", scene, "--json", "-"}));
  REQUIRE_FALSE(built["cells"].empty());
  REQUIRE(asRefined["cells"].size() == built["cells"].size());
  for (std::size_t c = 0; c < built["cells"].size(); ++c)
    CHECK(asRefined["cells"][c]["ecc"] == Approx(built["cells"][c]["ecc"].get<double>()).epsilon(0.002));  // own tracks
  const json off = reportOf(runProgram(wall.line({"build", wall.photographs, "-o", scene})));
  CHECK_FALSE(off.contains("refinement"));
  CHECK(off["cells"][0]["ecc"] != built["cells"][0]["ecc"]);
  const json same = reportOf(runProgram(
      {"build", wall.photographs, "--model", wall.exact, "-o", scene, "--refine-poses", "on", "--json", "-"}));
  CHECK_FALSE(same.contains("refinement"));  // exact poses are not marked as estimates
}

TEST_CASE("a left-out photograph takes no part in pose refinement and is resected afterwards") {
  if (!test::deviceIsThere()) return;
  test::TemporaryFolder folder;
  const Wall wall(folder);
  const auto leftOut = [&](const std::string& refine) {
    return reportOf(runProgram(wall.line({"eval", "--leave-one-out", wall.photographs, "--refine-poses", refine,
                                          "--resect", "--no-backdrops", "--every", "3", "--work", folder / refine})));
  };
  const json off = leftOut("off"), refined = leftOut("on");
  CHECK(off["posesRefined"] == 0);
  CHECK(refined["views"].size() == 2);
  CHECK(refined["posesRefined"] == 2);
  CHECK(refined["mean"]["psnrCovered"] > off["mean"]["psnrCovered"].get<double>() + 3);
  CHECK(leftOut("on")["mean"] == refined["mean"]);  // cached result of the previous run
  CHECK(leftOut("on")["posesRefined"] == 2);
}

TEST_CASE("poses that points confirm are kept, and so are the matched cells") {
  test::TemporaryFolder folder;
  const Wall wall(folder);
  const std::string loose = folder / "loose", scene = folder / "scene";
  REQUIRE(
      runLab({"synth", "noise", "--model", wall.exact, "--pixels", "0", "--track-pixels", "0.3", "-o", loose}).code ==
      0);
  std::vector<std::string> line{"build", wall.photographs, "--model", loose,      "-o", scene, "--refine-poses",
                                "on",    "--json",         "-",       "--exclude"};
  for (int i = 4; i < 16; ++i) line.push_back(fmt::format("photo{:04}.jpg", i));
  const json report = reportOf(runProgram(line));
  CHECK(report["refinement"]["posesKept"] == true);
  CHECK(report["refinement"]["photographs"].empty());
  CHECK(report["model"] == loose);
  REQUIRE_FALSE(report["cells"].empty());
  CHECK_FALSE(std::filesystem::exists(folder / "scene/.refined"));
}

TEST_CASE("refine overwrites no model and respects masks and excluded photographs") {
  test::TemporaryFolder folder;
  const Wall wall(folder);
  for (const std::string& other : {wall.noisy, wall.exact}) {
    const test::Outcome refused =
        runProgram(wall.line({"refine", wall.photographs, "-o", other, "--truth", wall.exact}));
    CHECK(refused.code == 3);
    CHECK_THAT(refused.err, Catch::Contains(other) && Catch::Contains("-o "));
  }
  const json built =
      reportOf(runProgram(wall.line({"build", wall.photographs, "-o", folder / "scene", "--refine-poses", "on"})));
  CHECK(built["unused"].empty());
  // Masks half of each photograph.
  std::filesystem::create_directories(folder / "masks");
  Image8 mask(320, 240, 1, 255);
  std::fill(mask.values.begin(), mask.values.begin() + 320 * 120, std::uint8_t(0));
  for (int i = 0; i < 4; ++i) writeImage(folder / fmt::format("masks/photo{:04}.png", i), mask);
  const auto points = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"refine", wall.photographs, "-o", folder / "refined"});
    return reportOf(runProgram(wall.line(more)))["refinement"];
  };
  const json whole = points({}), half = points({"--masks", folder / "masks"});
  for (const char* tracks : {"tracksOfCells", "tracksOfModel"})
    CHECK(half[tracks].get<double>() < 0.7 * whole[tracks].get<double>());
  CHECK_FALSE(std::filesystem::exists(folder / "refined/.build"));
}

TEST_CASE("synth noise accepts only a COLMAP model") {
  test::TemporaryFolder folder;
  const std::string out = folder / "noisy";
  CHECK(runLab({"synth", "noise", "-o", out}).code == 1);
  CHECK(runLab({"synth", "planes", "--model", out, "-o", out}).code == 1);
  CHECK(runLab({"synth", "noise", "--model", folder / "none", "-o", out}).code == 2);
}
