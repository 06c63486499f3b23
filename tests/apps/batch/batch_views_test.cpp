// SPDX-License-Identifier: Apache-2.0
// `ibr render` and `ibr eval` on a tiny scene, with the validation layer.
#include <catch2/catch.hpp>
#include <limits>
#include <nlohmann/json.hpp>

#include "apps/support/run_program.h"
#include "apps/support/tiny_scene.h"
#include "base/file.h"
#include "io/image_file.h"
#include "support/json.h"
#include "support/temporary_folder.h"

namespace fs = std::filesystem;
using namespace ibr;
using Catch::Contains;

namespace {

test::Outcome runValidated(const std::vector<std::string>& arguments) {
  const auto outcome = test::runProgram(arguments, {.environment = {"VK_INSTANCE_LAYERS=VK_LAYER_KHRONOS_validation"}});
  INFO(outcome.out << outcome.err);
  CHECK(outcome.out.find("VUID") == std::string::npos);
  CHECK(outcome.err.find("VUID") == std::string::npos);
  return outcome;
}

std::size_t darkPixels(const Image8& image) {
  std::size_t count = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      count += image.pixel(x, y)[0] + image.pixel(x, y)[1] + image.pixel(x, y)[2] == 0;
  return count;
}

}  // namespace

TEST_CASE("render names images as a COLMAP model does, folders included") {
  if (!test::deviceIsThere()) return;
  test::TemporaryFolder folder;
  const auto outcome = runValidated({"render", test::tinyScene(), "--poses", test::tinySet().photographs / "sparse",
                                     "-o", folder / "out", "--json", "-"});
  REQUIRE(outcome.code == 0);
  for (const char* name : {"a/0.png", "a/1.png", "b/2.png"}) {
    const Image8 image = readImage(folder / "out" / name);
    CHECK((image.width == 192 && image.height == 144));
    CHECK(darkPixels(image) < image.values.size() / 3 / 2);
  }
  const auto report = test::parseJson(outcome.out);
  CHECK(report.at("views").size() == 3);
  CHECK(report.at("device").is_string());
  CHECK(report.at("settings").at("morph") == "ours");
}

TEST_CASE("render --size sets the size of the images") {
  if (!test::deviceIsThere()) return;
  test::TemporaryFolder folder;
  REQUIRE(runValidated({"render", test::tinyScene(), "--poses", test::tinySet().photographs / "sparse", "--size",
                        "120x72", "-o", folder / "out"})
              .code == 0);
  const Image8 image = readImage(folder / "out/a/0.png");
  CHECK((image.width == 120 && image.height == 72));
}

TEST_CASE("render --path auto:N writes N frames, with every setting") {
  if (!test::deviceIsThere()) return;
  test::TemporaryFolder folder;
  const std::vector<std::vector<std::string>> settings{{},
                                                       {"--blend", "dither"},
                                                       {"--tiers", "0"},
                                                       {"--colour", "ours"},
                                                       {"--cells", "1", "--extrapolation", "0.5"},
                                                       {"--composition", "cells"},
                                                       {"--composition", "gathered", "--photographs", "2"},
                                                       {"--render-scale", "0.7", "--texture-scale", "0.5"},
                                                       {"--preset", "reference"}};
  for (const auto& more : settings) {
    fs::remove_all(folder / "out");
    std::vector<std::string> line{"render", test::tinyScene(), "--path", "auto:5", "-o", folder / "out"};
    line.insert(line.end(), more.begin(), more.end());
    REQUIRE(runValidated(line).code == 0);
    for (int i = 0; i < 5; ++i) CHECK(fs::exists(folder / "out" / ("frame_000" + std::to_string(i) + ".png")));
    CHECK(!fs::exists(folder / "out/frame_0005.png"));
  }
}

TEST_CASE("a preset sets all settings, and explicit settings override the preset in any order") {
  if (!test::deviceIsThere()) return;
  test::TemporaryFolder folder;
  const auto settings = [&](std::vector<std::string> more) {
    std::vector<std::string> line{"render", test::tinyScene(), "--path", "auto:1", "-o", folder / "out", "--json", "-"};
    line.insert(line.end(), more.begin(), more.end());
    const auto outcome = runValidated(line);
    REQUIRE(outcome.code == 0);
    return test::parseJson(outcome.out).at("settings");
  };
  const auto fast = settings({"--preset", "fast"});
  CHECK((fast["cells"] == 2 && fast["photographs"] == 6 && fast["extrapolation"] == 1.0));
  CHECK(settings({}) == settings({"--preset", "balanced"}));
  CHECK(settings({})["tiers"] == 3);
  for (const auto& mixed :
       {settings({"--preset", "fast", "--cells", "7"}), settings({"--cells", "7", "--preset", "fast"})})
    CHECK((mixed["cells"] == 7 && mixed["photographs"] == 6));
}

TEST_CASE("render accepts transforms.json") {
  if (!test::deviceIsThere()) return;
  test::TemporaryFolder folder;
  const Intrinsics k = test::tinySet().cameras[0].camera.intrinsics;
  nlohmann::json json{{"w", k.width}, {"h", k.height}, {"fl_x", k.fx}, {"fl_y", k.fy}};
  for (const auto& [name, camera] : test::tinySet().cameras) {
    const glm::dvec3 p = camera.pose.position;  // no camera is rotated
    json["frames"].push_back({{"file_path", "./" + name},
                              {"transform_matrix", {{1, 0, 0, p.x}, {0, 1, 0, p.y}, {0, 0, 1, p.z}, {0, 0, 0, 1}}}});
  }
  writeFile(folder / "transforms.json", test::jsonLine(json));
  REQUIRE(runValidated({"render", test::tinyScene(), "--poses", folder / "transforms.json", "-o", folder / "a"}).code ==
          0);
  REQUIRE(
      runValidated({"render", test::tinyScene(), "--poses", test::tinySet().photographs / "sparse", "-o", folder / "b"})
          .code == 0);
  for (const char* name : {"a/0.png", "a/1.png", "b/2.png"}) {
    INFO(name);
    CHECK(readFile(folder / "a" / name) == readFile(folder / "b" / name));
  }
  json["frames"][1]["transform_matrix"][0][0] = 2;
  writeFile(folder / "transforms.json", test::jsonLine(json));
  const auto outcome =
      runValidated({"render", test::tinyScene(), "--poses", folder / "transforms.json", "-o", folder / "c"});
  CHECK(outcome.code == 3);
  CHECK_THAT(outcome.err, Contains("/frames/1/transform_matrix"));
}

TEST_CASE("render accepts a camera path") {
  if (!test::deviceIsThere()) return;
  test::TemporaryFolder folder;
  writeFile(folder / "path.json",
            R"({"version":1,"size":[64,48],"fps":2,"keys":[
                {"time":0,"position":[0,0,0],"rotation":[0,0,0,1],"fovY":0.8},
                {"time":1,"position":[0.4,0,0],"rotation":[0,0,0,1],"fovY":0.8}]})");
  REQUIRE(runValidated({"render", test::tinyScene(), "--poses", folder / "path.json", "-o", folder / "out", "--json",
                        folder / "report.json"})
              .code == 0);
  const auto viewsReport = test::parseJson(readTextFile(folder / "report.json"));
  for (const auto& view : viewsReport.at("views")) {
    const std::vector<double> tiers = view.at("tiers");
    REQUIRE(tiers.size() == 4);
    CHECK(tiers[0] + tiers[1] + tiers[2] + tiers[3] == Approx(view.at("coverage").get<double>()));
    CHECK(tiers[0] > 0.3);
    CHECK(tiers[1] == 0);  // rejected triangles are not drawn
    CHECK(view.at("coverage") > 0.8);
  }
  CHECK(readImage(folder / "out/frame_0002.png").width == 64);
  writeFile(folder / "path.json", R"({"version":1,"size":[64,48],"fps":2,"keys":[]})");
  const auto outcome =
      test::runProgram({"render", test::tinyScene(), "--poses", folder / "path.json", "-o", folder / "no"});
  CHECK(outcome.code == 3);
  CHECK_THAT(outcome.err, Contains("path.json") && Contains("/keys"));
  CHECK(!fs::exists(folder / "no"));
}

TEST_CASE("render rejects names outside the output folder and names of the same file") {
  test::TemporaryFolder folder;
  const Camera camera = test::tinySet().cameras[0].camera;
  test::writeColmapModel(folder / "out-of-it", {{"../../x.jpg", camera}});
  test::writeColmapModel(folder / "same", {{"a.jpg", camera}, {"a.png", camera}});
  for (const char* model : {"out-of-it", "same"}) {
    const auto outcome =
        test::runProgram({"render", test::tinyScene(), "--poses", folder / model, "-o", folder / "deep/er/out"});
    INFO(model << outcome.err);
    CHECK(outcome.code == 3);
    CHECK(!fs::exists(folder / "deep"));
  }
}

TEST_CASE("eval reports all documented keys and writes images") {
  if (!test::deviceIsThere()) return;
  test::TemporaryFolder folder;
  const auto outcome = runValidated({"eval", test::tinyScene(), "--truth", test::tinySet().photographs, "-o",
                                     folder / "out", "--json", folder / "eval.json"});
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  CHECK_THAT(outcome.out, Contains("PSNR") && Contains("b/2.png"));
  const auto report = test::parseJson(readTextFile(folder / "eval.json"));
  for (const char* key : {"device", "settings", "scene"}) CHECK(report.contains(key));
  REQUIRE(report.at("views").size() == 3);
  double sum = 0;
  for (const auto& view : report.at("views")) {
    for (const char* key : {"name", "psnr", "ssim", "flip", "coverage", "coverageTier0", "coverageTier2", "psnrCovered",
                            "ssimCovered", "msSsim", "detailEnergy", "detailCorrelation", "milliseconds"})
      CHECK(view.contains(key));
    CHECK(view["flip"] < 0.05);
    CHECK(view["coverageTier0"].get<double>() + view["coverageTier2"].get<double>() <=
          view["coverage"].get<double>() + 1e-12);
    // At its own pose a photograph is reproduced completely. null: images are equal.
    CHECK((view["psnr"].is_null() || view["psnr"] > 40));
    CHECK((view["psnrCovered"].is_null() || view["psnrCovered"] > 40));
    CHECK(view["coverage"] == 1.0);
    CHECK(view["ssimCovered"] > 0.99);
    CHECK(view["detailEnergy"].get<double>() == Approx(1).margin(0.02));
    CHECK(view["detailCorrelation"] > 0.99);
    CHECK(view["milliseconds"] > 0);
    sum += view["ssim"].get<double>();
  }
  CHECK(report.at("mean").at("ssim").get<double>() == Approx(sum / 3));
  const Image8 shown = readImage(folder / "out/a/1.png");
  CHECK((shown.width == 3 * 192 && shown.height == 144));
}

TEST_CASE("eval scores a view between the photographs as close to the truth") {
  if (!test::deviceIsThere()) return;
  const auto outcome =
      runValidated({"eval", test::tinyScene(), "--truth", test::tinySet().truth, "--tiers", "2", "--json", "-"});
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  const auto view = test::parseJson(outcome.out).at("views").at(0);
  CHECK(view.at("name") == "between.png");
  CHECK(view.at("coverage") > 0.5);
  CHECK(view.at("psnrCovered") > 25);
  CHECK(view.at("psnrCovered") > view.at("psnr"));
  CHECK(view.at("ssimCovered") > 0.8);
  CHECK(view.at("detailCorrelation") > 0.7);
  CHECK(view.at("msSsim").is_null());  // undefined for 144 rows
}

TEST_CASE("an overlay overrides the preset in any order") {
  if (!test::deviceIsThere()) return;
  test::TemporaryFolder folder;
  for (const bool before : {false, true}) {
    std::vector<std::string> line{"render", test::tinyScene(), "--path", "auto:2", "-o", folder / "out", "--json", "-"};
    for (const char* word : before ? std::array{"--overlay", "tiers", "--preset", "fast"}
                                   : std::array{"--preset", "fast", "--overlay", "tiers"})
      line.push_back(word);
    const auto outcome = runValidated(line);
    REQUIRE(outcome.code == 0);
    CHECK(test::parseJson(outcome.out).at("settings").at("overlay") == "tiers");
  }
}

TEST_CASE("eval --seams separates colour differences from misalignment") {
  if (!test::deviceIsThere()) return;
  const auto outcome =
      runValidated({"eval", test::tinyScene(), "--truth", test::tinySet().truth, "--seams", "--json", "-"});
  REQUIRE(outcome.code == 0);
  const auto mean = test::parseJson(outcome.out).at("mean");
  CHECK(mean.at("deltaE") > 0);
  CHECK(mean.at("deltaE") < 10);  // all photographs have one exposure
  CHECK(mean.contains("seam"));
  CHECK(mean.contains("seamDeltaE"));
  for (const char* figure : {"misalignedPx", "misaligned95Px", "uncorrectedPx", "uncorrected95Px"})
    CHECK(mean.contains(figure));
  const auto without = runValidated({"eval", test::tinyScene(), "--truth", test::tinySet().truth, "--json", "-"});
  CHECK(test::parseJson(without.out).at("mean").at("deltaE").is_null());
}

TEST_CASE("eval accepts selected views and images/ beside the model, and rejects a truth of another size") {
  if (!test::deviceIsThere()) return;
  test::TemporaryFolder folder;
  const test::TinySet& set = test::tinySet();
  const auto some =
      runValidated({"eval", test::tinyScene(), "--truth", set.photographs, "--views", "a/1.png", "--json", "-"});
  REQUIRE(some.code == 0);
  CHECK(test::parseJson(some.out).at("views").size() == 1);
  CHECK(test::runProgram({"eval", test::tinyScene(), "--truth", set.photographs, "--views", "none.png"}).code == 3);

  // A truth folder as data sets have them: images/ beside cameras.txt, with one image missing.
  test::writeColmapModel(folder / "truth", {{"0.png", set.cameras[0].camera}, {"gone.png", set.cameras[1].camera}});
  fs::create_directories(folder / "truth/images");
  fs::copy_file(set.photographs / "a/0.png", folder / "truth/images/0.png");
  const auto missing = runValidated({"eval", test::tinyScene(), "--truth", folder / "truth", "--json", "-"});
  REQUIRE(missing.code == 0);
  CHECK(test::parseJson(missing.out).at("views").size() == 1);
  CHECK_THAT(missing.err, Contains("warning:") && Contains("gone.png"));

  writeImage(folder / "truth/images/0.png", Image8(50, 40, 3));
  const auto wrong = test::runProgram({"eval", test::tinyScene(), "--truth", folder / "truth"});
  CHECK(wrong.code == 3);
  CHECK_THAT(wrong.err, Contains("50×40") && Contains("192×144"));
}

TEST_CASE("eval --masks excludes masked pixels of the truth from all scores") {
  if (!test::deviceIsThere()) return;
  test::TemporaryFolder folder;
  const test::TinySet& set = test::tinySet();
  const auto scores = [&](const std::vector<std::string>& more) {
    std::vector<std::string> line{"eval", test::tinyScene(), "--truth", folder / "truth", "--json", "-"};
    line.insert(line.end(), more.begin(), more.end());
    const auto outcome = runValidated(line);
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    return test::parseJson(outcome.out).at("views").at(0);
  };
  fs::copy(set.truth, folder / "truth", fs::copy_options::recursive);
  const auto clean = scores({});
  Image8 spoilt = readImage(folder / "truth/images/between.png"), mask(spoilt.width, spoilt.height, 1, 255);
  for (int y = 40; y < 90; ++y)
    for (int x = 60; x < 110; ++x) {
      for (std::size_t c = 0; c < 3; ++c) spoilt.pixel(x, y)[c] = std::uint8_t(255 - spoilt.pixel(x, y)[c]);
      mask.pixel(x, y)[0] = 0;
    }
  writeImage(folder / "truth/images/between.png", spoilt);
  fs::create_directories(folder / "masks");
  writeImage(folder / "masks/between.png.png", mask);
  const auto spoiled = scores({}), masked = scores({"--masks", folder / "masks"});
  for (const char* score : {"psnr", "ssim", "psnrCovered", "ssimCovered"}) {
    INFO(score);
    const double before = clean.at(score), without = spoiled.at(score), with = masked.at(score);
    CHECK(without < 0.95 * before);
    CHECK(with == Approx(before).epsilon(0.04));
  }
  CHECK(double(spoiled.at("flip")) > 1.1 * double(clean.at("flip")));
  CHECK(double(masked.at("flip")) == Approx(double(clean.at("flip"))).epsilon(0.1));

  writeImage(folder / "masks/between.png.png", Image8(8, 8, 1, 255));
  const auto wrong =
      test::runProgram({"eval", test::tinyScene(), "--truth", folder / "truth", "--masks", folder / "masks"});
  CHECK(wrong.code == 3);
  CHECK_THAT(wrong.err, Contains("between.png.png") && Contains("192") && Contains("144"));
}

TEST_CASE("walk reports equal frames for a still camera and steps for a moving camera") {
  if (!test::deviceIsThere()) return;
  test::TemporaryFolder folder;
  writeFile(folder / "still.json", std::string_view(R"({"version": 1, "size": [96, 72], "fps": 30, "keys": [
    {"time": 0, "position": [0.3, 0, 0.1], "rotation": [0, 0, 0, 1], "fovY": 0.8},
    {"time": 0.3, "position": [0.3, 0, 0.1], "rotation": [0, 0, 0, 1], "fovY": 0.8}]})"));
  const auto still = runValidated({"walk", test::tinyScene(), "--poses", folder / "still.json", "--json", "-"});
  REQUIRE(still.code == 0);
  auto report = test::parseJson(still.out);
  CHECK(report.at("frames").size() == 10);
  CHECK(report.at("maxStep") == 0);
  CHECK(report.at("switches") == 0);
  CHECK(report.at("maxStepAtSwitch").is_null());
  CHECK(report.at("flicker") == 0);
  CHECK(report.at("pop").is_null());
  CHECK(report.at("eyes").is_null());

  const auto moving = runValidated(
      {"walk", test::tinyScene(), "--frames", "12", "--size", "96x72", "-o", folder / "worst", "--json", "-"});
  REQUIRE(moving.code == 0);
  report = test::parseJson(moving.out);
  CHECK(report.at("medianStep") > 0);
  CHECK(report.at("maxStep") >= report.at("medianStep"));
  double tiers = 0;
  for (const auto& share : report.at("frames").at(5).at("coverageTier")) tiers += double(share);
  CHECK(tiers == Approx(double(report.at("frames").at(5).at("coverage"))));
  const Image8 worst = readImage(folder / "worst/largest_step.png");
  CHECK((worst.width == 3 * 96 && worst.height == 72));
  CHECK(runValidated({"walk", test::tinyScene(), "--frames", "1"}).code == 1);
  CHECK(runValidated({"walk", test::tinyScene(), "--ipd", "0.1"}).code == 1);
}

TEST_CASE("walk reports flicker, pops and differences between the eyes") {
  if (!test::deviceIsThere()) return;
  const auto walked = [](std::vector<std::string> more) {
    std::vector<std::string> line{"walk", test::tinyScene(), "--frames", "24", "--size", "96x72", "--json", "-"};
    line.insert(line.end(), more.begin(), more.end());
    const auto outcome = runValidated(line);
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    return test::parseJson(outcome.out);
  };
  // Enables all state that changes over frames: cross-fades, exposure, colour tables.
  const auto report = walked({"--colour", "ours", "--blend", "dither", "--pop"});
  CHECK(report.at("flicker") == 0);
  CHECK(report.at("medianFlipStep") > 0);
  for (std::size_t i = 0; i < 24; ++i) CHECK(report.at("frames").at(i).at("flicker").is_null() == (i % 10 > 0));
  CHECK(report.at("flickerFrame") == 0);
  CHECK(report.at("flickerAt") == report.at("frames").at(0).at("name"));

  const auto eyes = walked({"--stereo", "--ipd", "0.02"}).at("eyes");
  CHECK(eyes.at("seenByBoth") > 0.5);
  CHECK(eyes.at("sameCell") > 0.9);
  CHECK(eyes.at("difference") < 6);
  CHECK(eyes.at("difference95") >= eyes.at("difference"));
  // Two eyes at the same position see the same image.
  const auto one = walked({"--stereo", "--ipd", "1e-9"}).at("eyes");
  CHECK(one.at("sameCell") == 1.0);
  CHECK(one.at("difference") < 1e-3);
}

TEST_CASE("--vram-budget limits device memory and warns about reduced textures") {
  if (!test::deviceIsThere()) return;
  const auto info = test::runProgram({"info", test::tinyScene(), "--json", "-"});
  REQUIRE(info.code == 0);
  const auto memory = test::parseJson(info.out).at("memory").at("measured");
  const auto meshes = memory.at("positions").get<std::uint64_t>() + memory.at("indices").get<std::uint64_t>() +
                      memory.at("depth").get<std::uint64_t>();  // meshes and depth are always resident
  const auto textures = memory.at("textures").get<std::uint64_t>();
  const auto psnrWithin = [&](std::uint64_t budget, test::Outcome& outcome) {
    outcome = runValidated({"eval", test::tinyScene(), "--truth", test::tinySet().photographs, "--json", "-",
                            "--vram-budget", std::to_string(budget)});
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    const auto report = test::parseJson(outcome.out);
    const auto psnr = report.at("mean").at("psnr");
    return psnr.is_null() ? std::numeric_limits<double>::infinity() : psnr.get<double>();  // null: equal
  };
  test::Outcome enough, little;
  const double whole = psnrWithin(meshes + textures, enough), half = psnrWithin(meshes + textures * 3 / 4, little);
  CHECK_THAT(enough.err, !Contains("budget"));
  CHECK(test::parseJson(little.out).at("settings").at("vramBudget") == meshes + textures * 3 / 4);
  CHECK_THAT(little.err, Contains("warning:") && Contains("budget") && Contains("1/2"));
  CAPTURE(half, whole);
  CHECK(half < whole);
  CHECK(half > 22);
  const auto none = test::runProgram(
      {"render", test::tinyScene(), "--path", "auto:2", "-o", test::tinyFolder() / "no", "--vram-budget", "1K"});
  CHECK(none.code == 4);
  CHECK_THAT(none.err, Contains("1024 bytes"));
}
