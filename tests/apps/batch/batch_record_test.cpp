// SPDX-License-Identifier: Apache-2.0
// Metadata inside rendered images, and images rendered again from their metadata.
#include <catch2/catch.hpp>
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

TEST_CASE("an image rendered again from its metadata has the same bytes, also from a copied scene") {
  if (!test::deviceIsThere()) return;
  test::TemporaryFolder folder;
  writeFile(folder / "path.json",
            R"({"version":1,"size":[64,48],"fps":1,"keys":[
                {"time":0,"position":[0.31,0.02,-0.1],"rotation":[0.02,0.1,-0.03,0.9943],"fovY":0.8}]})");
  const std::vector<std::string> settings{"--colour",        "ours", "--cells", "2", "--floor", "1",
                                          "--floor-spacing", "0.3",  "--mute",  "0"};
  const auto render = [&](const fs::path& scene, const fs::path& poses, const char* out) {
    std::vector<std::string> line{"render", scene, "--poses", poses, "-o", folder / out};
    line.insert(line.end(), settings.begin(), settings.end());
    const auto outcome = test::runProgram(line);
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
  };
  render(test::tinyScene(), folder / "path.json", "a");
  fs::copy(test::tinyScene(), folder / "elsewhere", fs::copy_options::recursive);
  const fs::path picture = folder / "a/frame_0000.png";
  render(folder / "elsewhere", picture, "b");
  CHECK(readFile(picture) == readFile(folder / "b/frame_0000.png"));

  const auto info = test::runProgram({"info", picture, "--json", "-"});
  REQUIRE(info.code == 0);
  const auto json = test::parseJson(info.out);
  CHECK(json.at("settings").at("cells") == 2);
  CHECK(json.at("settings").at("floor") == 1.0);
  CHECK(json.at("settings").at("overlay").is_null());
  CHECK(json.at("settings").at("mute") == nlohmann::json::array({0}));
  CHECK(json.at("view").at("width") == 64);
  const std::string text = json.at("texts").at(0).at("text");
  CHECK_THAT(text, Contains("\"libibr\"") && !Contains("cene") && !Contains("frame_0000"));
  const auto shown = test::runProgram({"info", picture});
  CHECK_THAT(shown.out, Contains("--poses") && Contains("--colour ours") && Contains("--cells 2") &&
                            Contains("--texture-scale 1.0") && Contains("--mute 0") && !Contains("--overlay") &&
                            !Contains("--solo"));

  const auto other = test::runProgram({"render", test::tinyScene(), "--poses", picture, "-o", folder / "c"});
  CHECK(other.code == 0);  // the view comes from the image, settings from the command
  CHECK(readFile(picture) != readFile(folder / "c/frame_0000.png"));
  const auto larger =
      test::runProgram({"render", test::tinyScene(), "--poses", picture, "--size", "32x32", "-o", folder / "d"});
  CHECK(larger.code == 0);
  CHECK(readImage(folder / "d/frame_0000.png").width == 32);
}

TEST_CASE("images without a stored view are rejected as poses, and info accepts them") {
  test::TemporaryFolder folder;
  writeImage(folder / "a.png", Image8(5, 4, 3));
  const auto refused = test::runProgram({"render", test::tinyScene(), "--poses", folder / "a.png", "-o", folder / "o"});
  CHECK(refused.code == 3);
  CHECK_THAT(refused.err, Contains("a.png") && Contains("view"));
  CHECK(!fs::exists(folder / "o"));
  const auto info = test::runProgram({"info", folder / "a.png"});
  CHECK(info.code == 0);
  CHECK_THAT(info.out, Contains("5×4") && !Contains("--poses"));
  CHECK(test::runProgram({"info", folder / "a.png", "--explain"}).code == 5);
  writeImage(folder / "a.png", Image8(5, 4, 3), {{"ibr", "{\"version\":1"}});
  const auto broken = test::runProgram({"info", folder / "a.png"});
  CHECK(broken.code == 3);
  CHECK_THAT(broken.err, Contains("a.png") && Contains("JSON"));
}

TEST_CASE("--mute and --solo report a cell that the scene lacks") {
  test::TemporaryFolder folder;
  for (const char* option : {"--mute", "--solo"}) {
    const auto refused =
        test::runProgram({"render", test::tinyScene(), "--path", "auto:2", "-o", folder / "out", option, "0,99"});
    CHECK(refused.code == 3);
    CHECK_THAT(refused.err, Contains(option) && Contains("99"));
    CHECK(!fs::exists(folder / "out"));
  }
}
