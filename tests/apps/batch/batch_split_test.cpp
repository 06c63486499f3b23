// SPDX-License-Identifier: Apache-2.0
// Command lines of `ibr split`.
#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "apps/support/run_program.h"
#include "base/file.h"
#include "io/image_file.h"
#include "support/json.h"
#include "support/temporary_folder.h"

using namespace ibr;
using namespace ibr::test;
using Catch::Contains;
namespace fs = std::filesystem;

TEST_CASE("ibr split writes images, a model and a report, and rejects invalid options") {
  const TemporaryFolder folder;
  Image8 panorama(64, 32, 3, 90);
  writeImage(folder / "pano.png", panorama);
  const std::string pano = folder / "pano.png", out = folder / "faces";

  const Outcome made = runProgram({"split", pano, "-o", out, "--size", "20", "--json", "-"});
  INFO(made.err);
  REQUIRE(made.code == 0);
  const auto json = parseJson(made.out);
  CHECK(json.at("pictures") == 6);
  CHECK(json.at("size") == 20);
  CHECK(json.at("fovDegrees") == 105);
  for (const char* face : {"front", "right", "back", "left", "up", "down"})
    CHECK(readImage(fs::path(out) / fmt::format("images/pano_{}.png", face)) == Image8(20, 20, 3, 90));
  CHECK_THAT(readTextFile(fs::path(out) / "sparse/cameras.txt"), Contains("PINHOLE 20 20 "));

  CHECK(runProgram({"split", pano, "-o", folder / "one", "--views", "1", "--format", "jpg"}).code == 0);
  CHECK(fs::exists(folder / "one/images/pano_view00.jpg"));
  CHECK(runProgram({"split", pano, "-o", folder / "many", "--views", "5", "--poles"}).code == 0);
  CHECK(fs::exists(folder / "many/images/pano_up.png"));

  for (const char* fov : {"180", "0", "-5", "nan", "wide"})
    CHECK(runProgram({"split", pano, "-o", out, "--fov", fov}).code == 1);
  for (const char* views : {"0", "361", "sphere"})
    CHECK(runProgram({"split", pano, "-o", out, "--views", views}).code == 1);
  CHECK(runProgram({"split", pano, "-o", out, "--fov", "179.9999"}).code == 3);
  CHECK(runProgram({"split", folder / "no.png", "-o", out}).code == 2);
  CHECK(runProgram({"split", pano}).code == 1);
  const Outcome unposed = runProgram({"split", folder / "faces/images", "-o", out});
  CHECK(unposed.code == 3);
  CHECK_THAT(unposed.err, Contains("faces/images"));
}
