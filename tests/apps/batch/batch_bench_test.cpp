// SPDX-License-Identifier: Apache-2.0
// ibr-lab bench: keys of the report, on tiny images. Times are not checked.
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "apps/support/run_program.h"
#include "apps/support/tiny_scene.h"
#include "support/json.h"

using namespace ibr;
using Catch::Contains;
using test::runLab;
using test::runProgram;

TEST_CASE("bench of a synthetic scene reports frames and passes of every method", "[T26]") {
  if (!test::deviceIsThere()) return;
  const auto outcome = runLab({"bench", "stitched-5,panorama-1", "--detail", "0.05", "--size", "64x36", "--views", "1",
                               "--repeat", "2", "--stereo", "--json", "-"},
                              {.environment = {"VK_INSTANCE_LAYERS=VK_LAYER_KHRONOS_validation"}});
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  CHECK(outcome.err.find("VUID") == std::string::npos);
  const auto report = test::parseJson(outcome.out);
  for (const char* key : {"device", "size", "frames", "passes", "passTimes", "settings", "scene"})
    CHECK(report.contains(key));
  CHECK(report["size"] == nlohmann::json{64, 36});
  REQUIRE(report["frames"].size() == 2 * 10);
  std::size_t stereo = 0, paper = 0, mapped = 0, dithered = 0, hidden = 0;
  for (const auto& frame : report["frames"]) {
    for (const char* key :
         {"scene", "cells", "drawn", "triangles", "way", "colourMapping", "blend", "views", "medianMs", "p95Ms", "n",
          "ratioToPaper", "ratioToUnmapped", "ratioToTwoMono", "hiddenCorners", "ratioToWhole"})
      CHECK(frame.contains(key));
    CHECK((frame["way"] == "paper" || frame["way"] == "ours"));
    CHECK(frame["n"] == 2);
    CHECK(frame["cells"] == (frame["scene"] == "panorama-1" ? 1 : 5));
    CHECK(frame["drawn"] == frame["cells"]);
    CHECK(frame["triangles"] == (frame["scene"] == "panorama-1" ? 25920 : 28200));
    CHECK(frame["medianMs"] > 0);
    CHECK(frame["ratioToPaper"] > 0);
    CHECK(frame["ratioToTwoMono"].is_null() == (frame["views"] == 1));
    CHECK(frame["ratioToWhole"].is_null() != frame["hiddenCorners"].get<bool>());
    hidden += frame["hiddenCorners"].get<bool>();
    if (frame["way"] == "paper" && frame["colourMapping"] == "off") CHECK(frame["ratioToPaper"] == 1);
    stereo += frame["views"] == 2;
    paper += frame["way"] == "paper";
    mapped += frame["colourMapping"] != "off";
    dithered += frame["blend"] == "dither";
  }
  CHECK((stereo == 2 * 4 && paper == 2 * 4 && mapped == 2 * 4 && dithered == 2 && hidden == 2));
  REQUIRE(!report["passes"].empty());
  std::size_t tables = 0;
  for (const auto& pass : report["passes"]) {
    for (const char* key : {"scene", "cells", "way", "colourMapping", "views", "pass", "medianMs", "p95Ms", "n"})
      CHECK(pass.contains(key));
    if (pass["pass"] == "colour tables") {
      ++tables;
      CHECK((pass["way"] == "ours" && pass["colourMapping"] == "ours" && pass["scene"] == "stitched-5"));
    }
  }
  CHECK(tables == 2);  // one view and two views; a single panorama needs no colour mapping
}

TEST_CASE("bench compares a scene's composition with the paper's cells") {
  if (!test::deviceIsThere()) return;
  for (const std::string composition : {"gathered", "hybrid"}) {
    const auto outcome = runProgram({"bench", test::tinyScene(), "--composition", composition, "--size", "64x36",
                                     "--views", "1", "--repeat", "1", "--cells", "5", "--stereo", "--json", "-"});
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    const auto report = test::parseJson(outcome.out);
    for (const auto& frame : report["frames"])
      CHECK(frame["composition"] == (frame["way"] == "paper" ? "cells" : composition));
    bool gathers = false;
    for (const auto& pass : report["passes"]) gathers |= pass["composition"] == composition && pass["pass"] == "vote";
    CHECK(gathers);
  }
}

TEST_CASE("bench rejects missing scenes and conflicting options") {
  using Lines = std::vector<std::vector<std::string>>;
  for (const auto& line : Lines{{"bench"}, {"bench", "scene", "--stereo", "--formats"}}) {
    const auto outcome = runProgram(line);
    CHECK(outcome.code == 1);
    CHECK(outcome.out.empty());
  }
  for (const auto& line : Lines{{"bench"}, {"bench", "stitched-6"}, {"bench", "all", "--detail", "0"}, {"matchers"}}) {
    const auto outcome = runLab(line);
    CHECK(outcome.code == 1);
    CHECK(outcome.out.empty());
  }
}
