// SPDX-License-Identifier: Apache-2.0
// `ibr htm` on a small generated body, with the validation layer.
#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>

#include "apps/support/run_program.h"
#include "io/image_file.h"
#include "support/bumpy_model.h"
#include "support/json.h"
#include "support/temporary_folder.h"

namespace fs = std::filesystem;
using namespace ibr;
using Catch::Contains;

namespace {

// Writes a model's folder as `ibr htm build` does.
void writeBumpy(const fs::path& folder, bool withSource) {
  test::BumpyModel bumpy = test::bumpyModel();
  fs::create_directories(folder);
  for (std::size_t i = 0; i < bumpy.pictures.size(); ++i) {
    HtmCamera& camera = bumpy.model.cameras[i];
    camera.imageFile = camera.name + ".png";
    camera.visibilityFile = camera.name + "_seen.png";
    writeImage(folder / camera.imageFile, bumpy.pictures[i].photograph);
    writeImage(folder / camera.visibilityFile, bumpy.pictures[i].visibility);
  }
  if (withSource) bumpy.model.source = bumpy.model.surface;
  saveHtmModel(bumpy.model, folder);
}

test::Outcome runValidated(const std::vector<std::string>& arguments) {
  const auto outcome = test::runProgram(arguments, {.environment = {"VK_INSTANCE_LAYERS=VK_LAYER_KHRONOS_validation"}});
  INFO(outcome.out << outcome.err);
  CHECK(outcome.out.find("VUID") == std::string::npos);
  CHECK(outcome.err.find("VUID") == std::string::npos);
  return outcome;
}

}  // namespace

TEST_CASE("htm render writes images with every method") {
  if (!test::deviceIsThere()) return;
  test::TemporaryFolder folder;
  writeBumpy(folder / "model", true);
  for (const char* method : {"htm", "vdtbm", "vdvbm"})
    for (const char* mesh : {"optimised", "source"}) {
      INFO(method << " " << mesh);
      fs::remove_all(folder / "out");
      const auto outcome = runValidated({"htm", "render", folder / "model", "--path", "auto:3", "--method", method,
                                         "--mesh", mesh, "-o", folder / "out", "--json", "-"});
      REQUIRE(outcome.code == 0);
      const auto report = test::parseJson(outcome.out);
      CHECK(report.at("settings").at("method") == method);
      REQUIRE(report.at("views").size() == 3);
      for (const auto& view : report.at("views")) {
        CHECK(view.at("coverage").get<double>() > 0.05);
        CHECK(view.at("rasterisationMs").get<double>() > 0);
        CHECK(fs::exists(view.at("file").get<std::string>()));
      }
    }
}

TEST_CASE("htm render at a camera's pose reproduces the photograph") {
  if (!test::deviceIsThere()) return;
  test::TemporaryFolder folder;
  writeBumpy(folder / "model", false);
  const Camera camera = test::bumpyModel().model.cameras[0].camera;
  const glm::dquat& q = camera.pose.rotation;
  const nlohmann::json path{{"version", 1},
                            {"size", {camera.intrinsics.width, camera.intrinsics.height}},
                            {"fps", 1},
                            {"keys",
                             {{{"time", 0},
                               {"position", {camera.pose.position.x, camera.pose.position.y, camera.pose.position.z}},
                               {"rotation", {q.x, q.y, q.z, q.w}},
                               {"fovY", 2 * std::atan(0.5 * camera.intrinsics.height / camera.intrinsics.fy)}}}}};
  std::ofstream(folder / "path.json") << test::jsonLine(path);
  const auto outcome = runValidated({"htm", "render", folder / "model", "--poses", folder / "path.json", "--gamma",
                                     "200", "-o", folder / "out", "--size", "160x120"});
  REQUIRE(outcome.code == 0);
  const Image8 picture = readImage(folder / "out/frame_0000.png"), photograph = readImage(folder / "model/camera0.png");
  double error = 0;
  for (int y = 50; y < 70; ++y)
    for (int x = 70; x < 90; ++x)
      for (std::size_t c = 0; c < 3; ++c) error += std::abs(picture.pixel(x, y)[c] - photograph.pixel(x, y)[c]);
  CHECK(error / (20 * 20 * 3) < 1);
}

TEST_CASE("htm names missing options and rejects missing inputs") {
  test::TemporaryFolder folder;
  CHECK(test::runProgram({"htm"}).code == 1);
  const auto unknown = test::runProgram({"htm", "nothing"});
  CHECK(unknown.code == 1);
  CHECK_THAT(unknown.err, Contains("ibr htm --help"));
  const auto bare = test::runProgram({"htm", "render", folder / "model", "-o", folder / "out"});
  CHECK(bare.code == 1);
  CHECK_THAT(bare.err, Contains("--poses") && Contains("ibr htm render --help"));
  CHECK(test::runProgram({"htm", "render", folder / "model", "--path", "auto:2", "-o", folder / "out"}).code == 2);
  const auto help = test::runProgram({"htm", "render", "--help"});
  CHECK(help.code == 0);
  CHECK_THAT(help.out, Contains("ibr htm render model --path") && Contains("Usage: ibr htm render [") &&
                           Contains("--method") && Contains("--json"));
  CHECK_THAT(test::runProgram({"htm", "--help"}).out, Contains("render"));
  writeBumpy(folder / "model", false);
  const auto noSource = test::runProgram(
      {"htm", "render", folder / "model", "--path", "auto:2", "--mesh", "source", "-o", folder / "out"});
  CHECK(noSource.code == 3);
}
