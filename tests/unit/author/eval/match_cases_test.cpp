// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>

#include "base/file.h"
#include "ibr/error.h"
#include "ibr/lab/matchers.h"
#include "io/image_file.h"
#include "lab/generate/synthetic.h"
#include "support/posed_rig.h"
#include "support/temporary_folder.h"

using namespace ibr;
using namespace ibr::test;

namespace {

std::string refusal(const std::string& json) {
  const TemporaryFolder folder;
  writeFile(folder / "cases.json", json);
  try {
    readMatchCases(folder / "cases.json", "data");
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::invalidInput);
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("match cases are read, with paths relative to the data folder") {
  const TemporaryFolder folder;
  writeFile(folder / "cases.json",
            R"({"cases": [{"name": "a", "images": ["x/1.png", "x/2.png"], "homography": "h.xml", "maxSize": 300},
                {"name": "b", "images": ["1.png", "2.png", "3.png"], "model": "sparse", "depth": "gt",
                 "depthUnit": 0.5}]})");
  const std::vector<MatchCase> cases = readMatchCases(folder / "cases.json", "data");
  REQUIRE(cases.size() == 2);
  CHECK(cases[0].name == "a");
  CHECK(cases[0].images[1] == "data/x/2.png");
  CHECK(cases[0].homography == "data/h.xml");
  CHECK(cases[0].maxSize == 300);
  CHECK(cases[0].model.empty());
  CHECK(cases[1].images.size() == 3);
  CHECK(cases[1].depth == "data/gt");
  CHECK(cases[1].depthUnit == 0.5);
}

TEST_CASE("an invalid match case is reported with its JSON pointer") {
  const std::string head = R"({"cases": [{"name": "a", "images": ["1.png", "2.png"])";
  for (const auto& [json, place] : std::vector<std::pair<std::string, std::string>>{
           {"{", "cases.json"},
           {"[]", "/cases"},
           {R"({"cases": [3]})", "/cases/0"},
           {R"({"cases": [{"images": ["1.png", "2.png"]}]})", "/cases/0/name"},
           {R"({"cases": [{"name": "a"}]})", "/cases/0/images"},
           {R"({"cases": [{"name": "a", "images": ["1.png"]}]})", "/cases/0/images"},
           {R"({"cases": [{"name": "a", "images": ["1.png", 2]}]})", "/cases/0/images/1"},
           {head + R"(, "maxSize": -1}]})", "/cases/0/maxSize"},
           {head + R"(, "depthUnit": 0}]})", "/cases/0/depthUnit"},
           {head + R"(, "depth": "gt"}]})", "/cases/0/model"},
           {head + R"(, "disparity": "d.png", "homography": "h.xml"}]})", "/cases/0/homography"},
           {head + R"(, "colour": "red"}]})", "/cases/0/colour"}}) {
    INFO(json);
    CHECK_THAT(refusal(json), Catch::Contains(place));
  }
}

TEST_CASE("methods are compared on a wall of known homography, and a missing image is reported") {
  const TemporaryFolder folder;
  // Cameras turned about one centre: their pictures are related by a homography.
  const std::vector<Camera> cameras{lookingAlong({0, 0, 0}, {0, 1, 0}, 240, 180),
                                    lookingAlong({0, 0, 0}, {0.12, 1, 0.04}, 240, 180)};
  SyntheticOptions options;
  options.cameras = cameras;
  options.planes = {{{0, 5, 0}, {1, 0, 0}, {0, 0, 1}, 20, 20, 1, 0.14}};
  options.samplesPerAxis = 2;
  const SyntheticScene scene = makeScene(options);
  for (int i = 0; i < 2; ++i) writeImage(folder / (std::to_string(i) + ".png"), scene.photographs[std::size_t(i)]);
  const Intrinsics& k = cameras[0].intrinsics;
  // Homography between pixel indices, whose origin is the first pixel's centre: K R K⁻¹.
  const glm::dmat3 toRay(1 / k.fx, 0, 0, 0, -1 / k.fy, 0, (0.5 - k.cx) / k.fx, (k.cy - 0.5) / k.fy, -1);
  const glm::dmat3 h =
      glm::inverse(toRay) * glm::mat3_cast(glm::inverse(cameras[1].pose.rotation) * cameras[0].pose.rotation) * toRay;
  std::string numbers;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) numbers += fmt::format("{:.12e} ", h[column][row]);
  writeFile(folder / "h.xml",
            "<?xml version=\"1.0\"?>\n<opencv_storage>\n<H type_id=\"opencv-matrix\"><rows>3</rows>"
            "<cols>3</cols><dt>d</dt><data>" +
                numbers + "</data></H>\n</opencv_storage>\n");
  MatchCase which{"wall", {folder / "0.png", folder / "1.png"}};
  which.homography = folder / "h.xml";
  const std::vector<MatchScore> scores = compareMatchMethods(which);
  REQUIRE(scores.size() == 3);
  CHECK(scores[0].method == MatchMethod::flow);
  CHECK(scores[2].filter == TriangleFilter::homogeneous);
  for (const MatchScore& score : scores) {
    CHECK(score.medianPx < 0.15);
    CHECK(score.within1Px > 0.97);
    CHECK(score.coverage > 0.4);
    CHECK(score.memberPsnr > 30);
    CHECK(std::isnan(score.completeness));
  }
  CHECK(std::isnan(scores[0].homogeneous));
  CHECK(scores[1].homogeneous > 0.9);
  which.images[1] = folder / "missing.png";
  CHECK_THROWS_WITH(compareMatchMethods(which), Catch::Contains("missing.png"));
}
