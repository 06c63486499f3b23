// SPDX-License-Identifier: Apache-2.0
// `ibr htm build` and `ibr htm eval` on the files of a small body made in code.
#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>

#include "apps/support/run_program.h"
#include "base/file.h"
#include "io/image_file.h"
#include "support/contents_below.h"
#include "support/htm_files.h"
#include "support/json.h"
#include "support/temporary_folder.h"

namespace fs = std::filesystem;
using namespace ibr;
using Catch::Contains;
using nlohmann::json;
using test::runLab;
using test::runProgram;

namespace {

test::BumpyOptions bodyOptions() {
  test::BumpyOptions options;
  options.cameras = 6;
  options.disagreement = 0;
  options.longitudes = 16;
  options.latitudes = 10;
  return options;
}

// Files of the body, the model that the program builds from them, and true views between the cameras.
struct Built {
  test::TemporaryFolder folder;
  fs::path files = folder / "files", model = folder / "model", truth = folder / "truth";
  test::Outcome outcome;

  std::vector<std::string> arguments(const fs::path& output) const {
    const std::vector<std::pair<std::string, std::string>> options{{"--mesh", files / "mesh.obj"},
                                                                   {"--model", files / "sparse"},
                                                                   {"--images", files / "images"},
                                                                   {"--masks", files / "masks"},
                                                                   {"--output", output},
                                                                   {"--faces", "0"},
                                                                   {"--rounds", "1"},
                                                                   {"--adjust", "1"},
                                                                   {"--radius", "3"},
                                                                   {"--later-radius", "2"}};
    std::vector<std::string> all{"htm", "build"};
    for (const auto& [name, value] : options) all.insert(all.end(), {name, value});
    return all;
  }
  Built() {
    test::writeHtmFiles(test::bumpyModel(bodyOptions()), files);
    test::BumpyOptions all = bodyOptions();
    all.cameras *= 2;  // every second view lies between two cameras of the model
    test::BumpyModel views = test::bumpyModel(all);
    views.model.cameras = {views.model.cameras[1], views.model.cameras[5]};
    views.pictures = {views.pictures[1], views.pictures[5]};
    for (std::size_t i = 0; i < 2; ++i) views.model.cameras[i].name = "between" + std::to_string(i);
    test::writeHtmFiles(views, truth);
    auto with = arguments(model);
    with.insert(with.end(), {"--stages", folder / "stages", "--json", folder / "report.json"});
    outcome = runProgram(with);
  }
};
const Built& built() {
  static const Built once;
  INFO(once.outcome.err);
  REQUIRE(once.outcome.code == 0);
  return once;
}

void checkScores(const json& scores) {
  for (const char* method : {"htm", "vdtbm", "vdvbm"}) {
    CHECK(scores.at(method).at("psnr").get<double>() > 5);
    CHECK(scores.at(method).at("ssim").get<double>() > 0.05);
    CHECK(scores.at(method).at("ssim").get<double>() <= 1);
  }
}

std::vector<std::string> joined(std::vector<std::string> a, const std::vector<std::string>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

}  // namespace

TEST_CASE("htm build writes a model and a report") {
  const Built& once = built();
  const auto report = test::parseJson(readTextFile(once.folder / "report.json"));
  for (const char* key : {"model", "mesh", "sourceFaces", "reducedFaces", "toReduced", "toSource", "adjustments",
                          "collapses", "differenceReduced", "differenceCollapsed", "rounds", "camerasPerVertex",
                          "rejected", "complementBytes", "stages"})
    CHECK(report.contains(key));
  REQUIRE(report.at("rounds").size() == 1);
  CHECK(report["rounds"][0].at("faces") == report["reducedFaces"].get<int>() - 2 * report["collapses"].get<int>());
  CHECK(report["adjustments"].size() == 1);
  CHECK(report["camerasPerVertex"].get<double>() > 1);
  CHECK_THAT(once.outcome.out, Contains("D_f") && Contains(once.model.string()));
  CHECK(loadHtmModel(once.model).cameras.size() == 6);
  CHECK(validateHtmModelFiles(once.model).empty());
  for (const char* file :
       {"original.ply", "reduced-by-shape.ply", "reduced-by-texture.ply", "refined.ply", "stages.png"})
    CHECK(fs::exists(once.folder / "stages" / file));
  // A second build has the same result.
  test::TemporaryFolder other;
  REQUIRE(runProgram(once.arguments(other / "model")).code == 0);
  CHECK(test::contentsBelow(other / "model") == test::contentsBelow(once.model));
}

TEST_CASE("htm build rejects invalid inputs and writes nothing") {
  const Built& once = built();
  test::TemporaryFolder folder;
  const auto run = [&](const std::vector<std::string>& more) {
    return runProgram(joined(once.arguments(folder / "model"), more));
  };
  const auto unknown = run({"--exclude", "nobody.png"});
  CHECK(unknown.code == 3);
  CHECK_THAT(unknown.err, Contains("nobody.png"));
  CHECK(run({"--mean-difference", "300"}).code == 1);
  CHECK(run({"--smoothness", "nan"}).code == 1);
  CHECK(run({"--max-faces", "0"}).code == 1);
  CHECK(run({"--soft", "0"}).code == 1);
  CHECK(run({"--measure", "ssd"}).code == 1);
  auto arguments = once.arguments(folder / "model");
  arguments[3] = folder / "none.obj";
  const auto noMesh = runProgram(arguments);
  CHECK(noMesh.code == 2);
  CHECK_THAT(noMesh.err, Contains("none.obj"));
  arguments = once.arguments(folder / "model");
  arguments[9] = folder.path();
  const auto noMask = runProgram(arguments);
  CHECK(noMask.code == 2);
  CHECK_THAT(noMask.err, Contains("camera0.png"));
  CHECK(!fs::exists(folder / "model"));
  const auto bare = runProgram({"htm", "build"});
  CHECK(bare.code == 1);
  CHECK_THAT(bare.err, Contains("ibr htm build --help"));
  const auto help = runProgram({"htm", "build", "--help-all"});
  CHECK(help.code == 0);
  for (const char* option : {"--mesh", "--model", "--images", "--masks", "--exclude", "--max-size", "--stages",
                             "--faces", "--adjust", "--measure", "--smoothness", "--rounds", "--no-reject", "--json"})
    CHECK_THAT(help.out, Contains(option));
}

TEST_CASE("htm eval scores each method against known views") {
  if (!test::deviceIsThere()) return;
  const Built& once = built();
  test::TemporaryFolder folder;
  const auto outcome =
      runProgram({"htm", "eval", once.model, "--truth", once.truth, "-o", folder / "out", "--json", "-"});
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  const auto report = test::parseJson(outcome.out);
  REQUIRE(report.at("views").size() == 2);
  for (const auto& view : report["views"]) {
    CHECK_THAT(view.at("name").get<std::string>(), Contains("between"));
    checkScores(view);
    CHECK(view.at("htm").at("psnr") > 15);
    CHECK(view.at("htm").at("psnr") > view.at("vdvbm").at("psnr"));
  }
  checkScores(report.at("mean"));
  CHECK(
      report["mean"]["htm"]["psnr"].get<double>() ==
      Approx((report["views"][0]["htm"]["psnr"].get<double>() + report["views"][1]["htm"]["psnr"].get<double>()) / 2));
  for (const char* key : {"device", "settings", "model"}) CHECK(report.contains(key));
  CHECK_THAT(readTextFile(folder / "out/psnr.svg"), Contains("<svg"));
  const Image8 row = readImage(folder / "out/between0.png");
  CHECK(row.width % 4 == 0);
  const auto one =
      runProgram({"htm", "eval", once.model, "--truth", once.truth, "--views", "between1.png", "--json", "-"});
  REQUIRE(one.code == 0);
  CHECK(test::parseJson(one.out).at("views").size() == 1);
  CHECK(test::parseJson(one.out)["views"][0] == report["views"][1]);
}

TEST_CASE("htm eval scores each photograph that is left out") {
  if (!test::deviceIsThere()) return;
  const Built& once = built();
  const auto kept = runProgram({"htm", "eval", once.model, "--leave-one-out", "--keep-mesh", "--json", "-"});
  INFO(kept.err);
  REQUIRE(kept.code == 0);
  const auto report = test::parseJson(kept.out);
  REQUIRE(report.at("views").size() == 6);
  for (const auto& view : report["views"]) checkScores(view);
  CHECK(report["settings"]["keepMesh"] == true);
  const auto again = runProgram({"htm", "eval", once.model, "--leave-one-out", "--views", "camera2.png", "--poses",
                                 once.files / "sparse", "--json", "-"});
  INFO(again.err);
  REQUIRE(again.code == 0);
  const auto one = test::parseJson(again.out);
  REQUIRE(one.at("views").size() == 1);
  CHECK(one["views"][0]["name"] == "camera2.png");
  checkScores(one["views"][0]);
  // The held-out photograph does not contribute, so its score is lower than with the photograph.
  const auto truth = test::parseJson(
      runProgram({"htm", "eval", once.model, "--truth", once.truth, "--views", "between0.png", "--json", "-"}).out);
  CHECK(report["views"][0]["htm"]["psnr"] < truth["views"][0]["htm"]["psnr"]);
}

TEST_CASE("with default options, harmonising scores no worse than blending, with and without masks") {
  if (!test::deviceIsThere()) return;
  test::TemporaryFolder folder;
  REQUIRE(runLab({"synth", "moving", "-o", folder / "frames", "--frames", "1", "--size", "256x256", "-q"}).code == 0);
  const fs::path frame = folder / "frames/frame0000";
  for (const bool masked : {true, false}) {
    INFO(masked);
    std::vector<std::string> build{"htm",     "build",          "--mesh",   frame / "mesh.ply",
                                   "--model", frame / "sparse", "--images", frame / "images",
                                   "-o",      folder / "model"};
    if (masked) build.insert(build.end(), {"--masks", frame / "masks"});
    REQUIRE(runProgram(build).code == 0);
    const auto compared = runProgram({"htm", "eval", folder / "model", "--truth", frame / "truth", "--json", "-"});
    REQUIRE(compared.code == 0);
    const json mean = test::parseJson(compared.out).at("mean");
    for (const char* figure : {"psnr", "psnrCovered"}) {
      const double htm = mean.at("htm").at(figure), blended = mean.at("vdtbm").at(figure);
      CHECK(htm > blended - 0.2);
    }
    // A held-out photograph without a mask must not contribute its own outline to the covered pixels.
    const auto left = runProgram({"htm", "eval", folder / "model", "--leave-one-out", "--keep-mesh", "--json", "-"});
    REQUIRE(left.code == 0);
    const json htm = test::parseJson(left.out).at("mean").at("htm");
    CHECK((htm.at("psnr") == htm.at("psnrCovered")) == !masked);
  }
}

TEST_CASE("htm eval rejects missing and conflicting options") {
  const Built& once = built();
  const auto bare = runProgram({"htm", "eval", once.model});
  CHECK(bare.code == 1);
  CHECK_THAT(bare.err, Contains("--leave-one-out") && Contains("ibr htm eval --help"));
  CHECK(runProgram({"htm", "eval", once.model, "--leave-one-out", "--truth", once.truth}).code == 1);
  CHECK(runProgram({"htm", "eval", once.model, "--truth", once.truth, "--keep-mesh"}).code == 1);
  CHECK(runProgram({"htm", "eval", once.folder / "none", "--leave-one-out"}).code == 2);
  const auto help = runProgram({"htm", "eval", "--help-all"});
  CHECK(help.code == 0);
  for (const char* option : {"--truth", "--leave-one-out", "--keep-mesh", "--poses", "--views", "--gamma", "--json"})
    CHECK_THAT(help.out, Contains(option));
  CHECK_THAT(runProgram({"htm", "--help"}).out, Contains("build") && Contains("eval"));
  if (!test::deviceIsThere()) return;
  const auto noView = runProgram({"htm", "eval", once.model, "--leave-one-out", "--views", "camera9.png"});
  CHECK(noView.code == 3);
  CHECK_THAT(noView.err, Contains("camera9.png"));
  CHECK(runProgram({"htm", "eval", once.model, "--truth", once.truth, "--views", "camera9.png"}).code == 3);
  CHECK(runProgram({"htm", "eval", once.model, "--truth", once.folder / "none"}).code != 0);
}
