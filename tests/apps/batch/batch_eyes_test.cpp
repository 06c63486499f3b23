// SPDX-License-Identifier: Apache-2.0
// `ibr render` with cameras that differ from the poses file: two eyes, another focal length.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdlib>
#include <map>
#include <nlohmann/json.hpp>

#include "apps/support/run_program.h"
#include "apps/support/tiny_scene.h"
#include "base/file.h"
#include "io/exr.h"
#include "io/image_file.h"
#include "support/json.h"
#include "support/temporary_folder.h"

namespace fs = std::filesystem;
using namespace ibr;
using Catch::Contains;

namespace {

Camera between() {
  return {test::tinySet().cameras[0].camera.intrinsics, {glm::dvec3(0.23, 0.13, 0), {1, 0, 0, 0}}};
}

test::Outcome render(const fs::path& poses, const fs::path& output, const std::vector<std::string>& more) {
  std::vector<std::string> line{"render", test::tinyScene(), "--poses", poses, "-o", output};
  line.insert(line.end(), more.begin(), more.end());
  return test::runProgram(line, {.environment = {"VK_INSTANCE_LAYERS=VK_LAYER_KHRONOS_validation"}});
}

}  // namespace

TEST_CASE("--stereo adds two eyes to a single pose and keeps given eyes") {
  if (!test::deviceIsThere()) return;
  test::TemporaryFolder folder;
  test::writeColmapModel(folder / "middle", {{"view.jpg", between()}});
  REQUIRE(render(folder / "middle", folder / "made", {"--stereo", "--ipd", "0.08"}).code == 0);
  Camera left = between(), right = between();
  left.pose.position.x -= 0.04;
  right.pose.position.x += 0.04;
  test::writeColmapModel(folder / "eyes", {{"view_r.jpg", right}, {"view_l.jpg", left}});
  const auto outcome = render(folder / "eyes", folder / "given", {"--stereo"});
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  CHECK(outcome.err.find("VUID") == std::string::npos);
  for (const char* name : {"view_l.png", "view_r.png"})
    CHECK(readImage(folder / "made" / name) == readImage(folder / "given" / name));
  CHECK(!(readImage(folder / "made/view_l.png") == readImage(folder / "made/view_r.png")));
  CHECK(!fs::exists(folder / "made/view.png"));

  // Off-centre principal points shift the image inside its frame; the surfaces stay at the same positions.
  left.intrinsics.cx += 16;
  right.intrinsics.cx -= 16;
  test::writeColmapModel(folder / "skewed", {{"view_l.jpg", left}, {"view_r.jpg", right}});
  REQUIRE(render(folder / "skewed", folder / "skewed-out", {"--stereo"}).code == 0);
  const Image8 straight = readImage(folder / "given/view_l.png"), skewed = readImage(folder / "skewed-out/view_l.png");
  for (int y = 0; y < straight.height; ++y)
    for (int x = 0; x + 16 < straight.width; ++x)
      for (std::size_t c = 0; c < 3; ++c) REQUIRE(std::abs(straight.pixel(x, y)[c] - skewed.pixel(x + 16, y)[c]) <= 1);
}

TEST_CASE("--stereo renders both eyes again from one eye's image, byte for byte") {
  if (!test::deviceIsThere()) return;
  test::TemporaryFolder folder;
  // Typical headset cameras: off-centre, canted, pixels not quite square, arbitrary numbers.
  Camera left = between(), right = between();
  left.pose = {left.pose.position - glm::dvec3(0.0317, 0, 0.0011), glm::angleAxis(0.0523, glm::dvec3(0, 1, 0))};
  right.pose = {right.pose.position + glm::dvec3(0.0317, 0, 0.0011), glm::angleAxis(-0.0417, glm::dvec3(0, 1, 0))};
  left.intrinsics.cx += 11.37;
  right.intrinsics.cx -= 9.81;
  left.intrinsics.fx *= 1.003;
  test::writeColmapModel(folder / "eyes", {{"shot_l.jpg", left}, {"shot_r.jpg", right}});
  const std::vector<std::string> more{"--stereo", "--preset", "accurate", "--floor", "1.5"};
  REQUIRE(render(folder / "eyes", folder / "given", more).code == 0);
  for (const char* eye : {"shot_l.png", "shot_r.png"}) {
    const auto outcome = render(folder / "given" / eye, folder / "again", more);
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    for (const char* name : {"shot_l.png", "shot_r.png"})
      CHECK((readFile(folder / "given" / name) == readFile(folder / "again" / name)));
    fs::remove_all(folder / "again");
  }
  // Without --stereo, or with another name, the file is a single view.
  REQUIRE(render(folder / "given/shot_l.png", folder / "alone", {}).code == 0);
  CHECK(!fs::exists(folder / "alone/shot_r.png"));
  fs::copy_file(folder / "given/shot_l.png", folder / "given/shot.png");
  REQUIRE(render(folder / "given/shot.png", folder / "pair", {"--stereo", "--ipd", "0.06"}).code == 0);
  CHECK((fs::exists(folder / "pair/shot_l.png") && fs::exists(folder / "pair/shot_r.png")));

  for (const auto& [kept, lost] : {std::pair("shot_l.png", "shot_r.png"), {"shot_r.png", "shot_l.png"}}) {
    fs::create_directories(folder / "lone");
    fs::copy_file(folder / "given" / kept, folder / "lone" / kept);
    const auto missing = render(folder / "lone" / kept, folder / "out", {"--stereo"});
    CHECK(missing.code == 3);
    CHECK_THAT(missing.err, Contains((folder / "lone" / kept).string()) && Contains((folder / "lone" / lost).string()));
    writeImage(folder / "lone" / lost, Image8(8, 6, 3));
    const auto recordless = render(folder / "lone" / kept, folder / "out", {"--stereo"});
    CHECK(recordless.code == 3);
    CHECK_THAT(recordless.err, Contains((folder / "lone" / lost).string()));
    CHECK(!fs::exists(folder / "out"));
    fs::remove_all(folder / "lone");
  }
}

TEST_CASE("--stereo names the missing eye") {
  test::TemporaryFolder folder;
  const auto refused = [&](const char* name) {
    test::writeColmapModel(folder / "poses", {{name, between()}});
    const auto outcome = render(folder / "poses", folder / "out", {"--stereo"});
    CHECK(outcome.code == 3);
    CHECK(!fs::exists(folder / "out"));
    return outcome.err;
  };
  CHECK_THAT(refused("hall_l.jpg"), Contains("hall_l.jpg") && Contains("hall_r"));
  CHECK_THAT(refused("hall_r.jpg"), Contains("hall_r.jpg") && Contains("hall_l"));
  CHECK_THAT(refused("hall.jpg"), Contains("--ipd"));
}

TEST_CASE("--fov: twice the focal length shows the centre of the image, twice as large") {
  if (!test::deviceIsThere()) return;
  test::TemporaryFolder folder;
  test::writeColmapModel(folder / "poses", {{"view.jpg", between()}});
  const Intrinsics k = between().intrinsics;
  const double degrees = 2 * std::atan(0.25 * k.height / k.fy) * 180 / M_PI;
  REQUIRE(render(folder / "poses", folder / "narrow", {"--fov", std::to_string(degrees)}).code == 0);
  REQUIRE(render(folder / "poses", folder / "large", {"--size", "384x288"}).code == 0);
  const Image8 narrow = readImage(folder / "narrow/view.png"), large = readImage(folder / "large/view.png");
  std::size_t wrong = 0;
  for (int y = 0; y < k.height; ++y)
    for (int x = 0; x < k.width; ++x)
      wrong += std::abs(narrow.pixel(x, y)[0] - large.pixel(x + k.width / 2, y + k.height / 2)[0]) > 2;
  CHECK(wrong < std::size_t(k.width * k.height) / 100);
}

TEST_CASE("--buffers writes depth, tier, weights and confidence of every pixel, and --overlay changes the image") {
  if (!test::deviceIsThere()) return;
  test::TemporaryFolder folder;
  test::writeColmapModel(folder / "poses", {{"view.jpg", between()}});
  const auto outcome =
      render(folder / "poses", folder / "out", {"--buffers", "--stereo", "--ipd", "0.06", "--json", "-"});
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  CHECK(outcome.err.find("VUID") == std::string::npos);
  const auto report = test::parseJson(outcome.out);
  CHECK(report.at("settings").at("ipd") == 0.06);
  CHECK(report.at("settings").at("fov").is_null());
  CHECK(report.at("views").at(1).at("buffers") == (folder / "out/view_r.exr").string());
  for (const char* eye : {"view_l", "view_r"}) {
    std::map<std::string, ImageF> channels;
    for (ExrChannel& channel : readExr(folder / "out" / (std::string(eye) + ".exr")))
      channels.emplace(channel.name, std::move(channel.values));
    for (const char* name : {"R", "G", "B", "Z", "tier", "rank", "weight.0", "weight.1", "weight.2", "weight.3",
                             "confidence.spread", "confidence.uncertainty", "confidence.extrapolation"})
      CHECK(channels.contains(name));
    REQUIRE(channels.size() == 13);
    const Image8 picture = readImage(folder / "out" / (std::string(eye) + ".png"));
    // The wall is 5 ahead.
    CHECK(channels["Z"].pixel(20, 20)[0] == Approx(5).epsilon(0.05));
    CHECK(channels["tier"].pixel(96, 72)[0] == 0);
    float sum = 0;
    for (int i = 0; i < 4; ++i) sum += channels["weight." + std::to_string(i)].pixel(96, 72)[0];
    CHECK(sum == Approx(1));
    const float linear = channels["G"].pixel(96, 72)[0];
    CHECK(1.055 * std::pow(linear, 1 / 2.4) - 0.055 == Approx(picture.pixel(96, 72)[1] / 255.0).margin(1e-3));
  }
  REQUIRE(render(folder / "poses", folder / "plain", {}).code == 0);
  CHECK(!fs::exists(folder / "plain/view.exr"));
  const Image8 plain = readImage(folder / "plain/view.png");
  REQUIRE(render(folder / "poses", folder / "edges", {"--overlay", "wireframe"}).code == 0);
  CHECK(!(readImage(folder / "edges/view.png") == plain));
  REQUIRE(render(folder / "poses", folder / "floor", {"--floor", "0.3", "--tiers", "0"}).code == 0);
}
