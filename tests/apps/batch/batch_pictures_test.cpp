// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/support/run_program.h"
#include "apps/support/tiny_scene.h"
#include "base/file.h"
#include "ibr/scene.h"
#include "ibr/texture.h"
#include "image/depth_texture.h"
#include "io/exr.h"
#include "io/image_file.h"
#include "support/json.h"
#include "support/temporary_folder.h"

namespace fs = std::filesystem;
using namespace ibr;
using test::runProgram;

TEST_CASE("compare reports metrics, applies the tolerance and writes a difference image") {
  test::TemporaryFolder folder;
  Image8 a(20, 20, 3, 100), b = a;
  b.pixel(3, 4)[1] = 110;    // 1 of 400 pixels differs by 10 levels
  b.pixel(19, 19)[2] = 103;  // another pixel differs by 3 levels
  writeImage(folder / "a.png", a);
  writeImage(folder / "b.png", b);
  const auto compare = [&](std::vector<std::string> more) {
    std::vector<std::string> line{"compare", folder / "a.png", folder / "b.png"};
    line.insert(line.end(), more.begin(), more.end());
    return runProgram(line).code;
  };
  CHECK(compare({}) == 0);
  CHECK(compare({"--tolerance", "0", "0.5", "10"}) == 0);
  CHECK(compare({"--tolerance", "0", "0.45", "255"}) == 6);
  CHECK(compare({"--tolerance", "3", "0.25", "10"}) == 0);
  CHECK(compare({"--tolerance", "3", "0.2", "10"}) == 6);
  CHECK(compare({"--tolerance", "0", "100", "9"}) == 6);

  const std::string json = folder / "report.json", picture = folder / "difference.png";
  CHECK(compare({"--tolerance", "3", "0.25", "10", "--json", json, "-o", picture, "--gain", "20"}) == 0);
  const auto report = test::parseJson(readTextFile(json));
  CHECK(report.at("maxDifference") == 10);
  CHECK(report.at("percentAbove").get<double>() == Approx(0.25));
  CHECK(report.at("meanDifference").get<double>() == Approx(13.0 / 1200));
  CHECK(report.at("psnr").get<double>() == Approx(10 * std::log10(255.0 * 255.0 * 1200 / 109)));
  CHECK(report.at("ssim").get<double>() < 1);
  CHECK(report.at("within") == true);
  CHECK((report.at("flip") > 0 && report.at("flip") < 0.1));
  Image8 expected(20, 20, 3, 0);
  expected.pixel(3, 4)[1] = 200;
  expected.pixel(19, 19)[2] = 60;
  CHECK(readImage(picture) == expected);

  const auto same =
      runProgram({"compare", folder / "a.png", folder / "a.png", "--tolerance", "0", "0", "0", "--json", "-"});
  CHECK(same.code == 0);
  CHECK(test::parseJson(same.out).at("psnr").is_null());
}

TEST_CASE("compare rejects images of different sizes and damaged images") {
  test::TemporaryFolder folder;
  writeImage(folder / "a.png", Image8(20, 10, 3));
  writeImage(folder / "b.png", Image8(10, 20, 3));
  const auto outcome = runProgram({"compare", folder / "a.png", folder / "b.png"});
  CHECK(outcome.code == 3);
  CHECK_THAT(outcome.err, Catch::Contains("20×10") && Catch::Contains("10×20"));
  std::string half = readTextFile(folder / "a.png");
  half.resize(half.size() / 2);
  writeFile(folder / "half.png", half);
  CHECK(runProgram({"compare", folder / "a.png", folder / "half.png"}).code == 3);
}

TEST_CASE("info writes depth, confirmations and consensus of each photograph as images and values") {
  test::TemporaryFolder folder;
  const Scene scene = loadScene(test::tinyScene());
  const auto outcome = test::runProgram({"info", test::tinyScene(), "--depth", folder / "depth"});
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  for (const Node& node : scene.nodes) {
    const std::string name = folder / "depth" / node.name;
    const std::vector<ExrChannel> channels = readExr(name + ".depth.exr");
    REQUIRE(channels.size() == 3);
    CHECK(channels[0].name == "confirmations");
    CHECK(channels[1].name == "consensus");
    CHECK(channels[2].name == "inverseDepth");
    const DepthMaps maps = readDepthTexture(readKtx2(scene.folder / node.depthFile), node.depthScale);
    CHECK(channels[1].values == maps.consensus);
    CHECK(channels[2].values == maps.inverseDepth);
    CHECK(std::ranges::any_of(channels[0].values.values, [](float c) { return c > 0; }));
    for (const char* what : {".depth.png", ".confirmations.png", ".consensus.png"})
      CHECK(readImage(name + what).width == maps.inverseDepth.width);
  }
  // A file that is no scene, and a scene without depth, are refused.
  const std::string picture = folder / "depth" / (scene.nodes[0].name + ".depth.png");
  CHECK(test::runProgram({"info", picture, "--depth", folder / "again"}).code != 0);
  Scene bare = scene;
  for (Node& node : bare.nodes) node.depthFile.clear(), node.depthScale = 0;
  fs::copy(test::tinyScene(), folder / "bare", fs::copy_options::recursive);
  saveScene(bare, folder / "bare");
  const auto none = test::runProgram({"info", folder / "bare", "--depth", folder / "again"});
  CHECK(none.code != 0);
  CHECK_THAT(none.err, Catch::Contains("bare") && Catch::Contains("depth"));
}
