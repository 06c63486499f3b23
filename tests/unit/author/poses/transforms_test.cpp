// SPDX-License-Identifier: Apache-2.0
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "ibr/author/poses.h"
#include "ibr/error.h"
#include "io/image_file.h"
#include "support/json.h"
#include "support/temporary_folder.h"

namespace fs = std::filesystem;
using namespace ibr;
using Catch::Contains;
using Json = nlohmann::json;

namespace {

// Two frames; the second one is at (1, 2, 3) and looks along −x: −z after a quarter turn about y.
Json example() {
  return test::parseJson(R"({
    "w": 640, "h": 480, "fl_x": 500, "fl_y": 510, "cx": 321, "cy": 239,
    "applied_scale": 2.5, "aabb_scale": 16,
    "frames": [
      {"file_path": "./images/b.png", "transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]},
      {"file_path": "images/a.png", "sharpness": 20.5,
       "transform_matrix": [[0,0,1,1],[0,1,0,2],[-1,0,0,3],[0,0,0,1]]}]})");
}

PosedModel read(const Json& json) {
  const test::TemporaryFolder folder;
  writeFile(folder / "transforms.json", test::jsonLine(json));
  return readTransforms(folder / "transforms.json");
}

std::string faultOf(const std::string& text) {
  const test::TemporaryFolder folder;
  writeFile(folder / "transforms.json", text);
  try {
    readTransforms(folder / "transforms.json");
  } catch (const Error& e) {
    CHECK(e.code() == ErrorCode::invalidInput);
    CHECK_THAT(e.what(), Contains("transforms.json: "));
    return e.what();
  }
  FAIL("nothing was thrown");
  return {};
}

}  // namespace

TEST_CASE("frames of transforms.json are read without conversion and sorted by name") {
  const PosedModel model = read(example());
  REQUIRE(model.images.size() == 2);
  CHECK(model.tracks.empty());
  CHECK(model.images[0].name == "images/a.png");
  CHECK(model.images[1].name == "images/b.png");
  const Camera& camera = model.images[0].camera;
  CHECK(camera.intrinsics == Intrinsics{CameraModel::pinhole, 640, 480, 500, 510, 321, 239});
  CHECK_FALSE(model.images[0].lens);
  CHECK(camera.pose.position == glm::dvec3(1, 2, 3));
  CHECK(glm::distance(viewAxis(camera.pose), glm::dvec3(-1, 0, 0)) < 1e-12);
  CHECK(glm::distance(camera.pose.rotation * glm::dvec3(0, 1, 0), glm::dvec3(0, 1, 0)) < 1e-12);
  CHECK(glm::distance(viewAxis(model.images[1].camera.pose), glm::dvec3(0, 0, -1)) < 1e-12);
}

TEST_CASE("a frame's intrinsics override the file's, and angles replace missing focal lengths") {
  Json json = example();
  json["frames"][1].update(Json{{"w", 100.0}, {"h", 50}, {"fl_x", 80}, {"cx", 49}});
  json.erase("fl_x");
  json.erase("cy");
  json["camera_angle_x"] = 1.2;
  const PosedModel model = read(json);
  CHECK(model.images[0].camera.intrinsics == Intrinsics{CameraModel::pinhole, 100, 50, 80, 510, 49, 25});
  CHECK(model.images[1].camera.intrinsics.fx == Approx(320 / std::tan(0.6)));

  json.erase("fl_y");
  CHECK(read(json).images[1].camera.intrinsics.fy == read(json).images[1].camera.intrinsics.fx);
  json["camera_angle_y"] = 1.0;
  CHECK(read(json).images[1].camera.intrinsics.fy == Approx(240 / std::tan(0.5)));
}

TEST_CASE("distorted frames are read with their lens") {
  Json json = example();
  json.update(Json{{"k1", -0.1}, {"k2", 0.02}, {"p1", 1e-3}, {"p2", -1e-3}});
  for (const char* name : {"", "OPENCV"}) {
    if (*name) json["camera_model"] = name;
    const PosedModel model = read(json);
    const Lens expected(LensModel::opencv, 640, 480, std::vector<double>{500, 510, 321, 239, -0.1, 0.02, 1e-3, -1e-3});
    REQUIRE(model.images[0].lens);
    CHECK(model.images[0].lens->distortion() == expected.distortion());
    CHECK(model.images[0].camera.intrinsics == undistorted(expected));
  }
  json["p1"] = json["p2"] = 0;
  json["camera_model"] = "OPENCV_FISHEYE";
  json["k4"] = 1e-3;
  CHECK(read(json).images[1].lens->model() == LensModel::opencvFisheye);
  CHECK(read(json).images[1].lens->distortion().numerator[3] == 1e-3);

  Json panorama = example();
  panorama["camera_model"] = "EQUIRECTANGULAR";
  CHECK(read(panorama).images[0].camera.intrinsics == Intrinsics{CameraModel::equirectangular, 640, 480, 0, 0, 0, 0});
  Json pinhole = example();
  pinhole["camera_model"] = "PINHOLE";
  CHECK_FALSE(read(pinhole).images[0].lens);
}

TEST_CASE("photographs are found relative to the file or to their folder, with or without extension") {
  const test::TemporaryFolder folder;
  fs::create_directories(folder / "set/images/deep");
  writeImage(folder / "set/images/a.png", Image8(32, 16, 3));
  writeImage(folder / "set/images/deep/b.jpg", Image8(32, 16, 3));
  Json json = example();
  json.erase("w");
  json.erase("h");
  const auto names = [&](const fs::path& photographs) {
    writeFile(folder / "set/transforms.json", test::jsonLine(json));
    const PosedModel model = readTransforms(folder / "set/transforms.json", photographs);
    CHECK(model.images[0].camera.intrinsics.width == 32);
    CHECK(model.images[0].camera.intrinsics.height == 16);
    return model.images[0].name + " " + model.images[1].name;
  };
  json["frames"][0]["file_path"] = "./images/a";
  json["frames"][1]["file_path"] = "images/deep/b";
  CHECK(names(folder / "set/images") == "a.png deep/b.jpg");
  CHECK(names(folder / "set") == "images/a.png images/deep/b.jpg");
  json["frames"][0]["file_path"] = "elsewhere/a.png";
  json["frames"][1]["file_path"] = "deep/b.jpg";
  CHECK(names(folder / "set/images") == "a.png deep/b.jpg");
  json["frames"][1]["file_path"] = "images/c";
  CHECK_THROWS_WITH(names(folder / "set/images"),
                    Contains("transforms.json") && Contains("/frames/1/file_path") && Contains("\"images/c\""));
  json["frames"][1]["file_path"] = "images/../images/a.png";
  CHECK_THROWS_WITH(names(folder / "set/images"),
                    Contains("transforms.json") && Contains("both match the photograph a.png"));
}

TEST_CASE("a fault of transforms.json is reported with its JSON pointer") {
  struct Spoilt {
    std::vector<const char*> tokens;  // of the message
    std::function<void(Json&)> spoil;
  };
  const Spoilt cases[] = {
      {{"\"frames\""}, [](Json& j) { j.erase("frames"); }},
      {{"/frames: "}, [](Json& j) { j["frames"] = Json::array(); }},
      {{"/frames/1: ", "transform_matrix"}, [](Json& j) { j["frames"][1].erase("transform_matrix"); }},
      {{"/frames/0/file_path: "}, [](Json& j) { j["frames"][0]["file_path"] = ""; }},
      {{"/frames/1/file_path", "images/b.png"}, [](Json& j) { j["frames"][1]["file_path"] = "images/b.png"; }},
      {{"/frames/1/transform_matrix: ", " 2 "},
       [](Json& j) {
         j["frames"][1]["transform_matrix"] = {1, 2};
       }},
      {{"/frames/1/transform_matrix/2: ", " 3 "},
       [](Json& j) {
         j["frames"][1]["transform_matrix"][2] = {1, 2, 3};
       }},
      {{"/frames/1/transform_matrix/0/3: "}, [](Json& j) { j["frames"][1]["transform_matrix"][0][3] = nullptr; }},
      {{"/frames/0/transform_matrix: ", " 1.1"}, [](Json& j) { j["frames"][0]["transform_matrix"][0][0] = 1.1; }},
      {{"/frames/0/transform_matrix: ", "0 and 1"}, [](Json& j) { j["frames"][0]["transform_matrix"][0][1] = 0.01; }},
      {{"/frames/0/transform_matrix: ", "determinant"}, [](Json& j) { j["frames"][0]["transform_matrix"][0][0] = -1; }},
      {{"/frames/0/transform_matrix/3: ", "0 0 0 1"}, [](Json& j) { j["frames"][0]["transform_matrix"][3][0] = 1; }},
      {{"/fl_x: ", "-5"}, [](Json& j) { j["fl_x"] = -5; }},
      {{"/frames/0: ", "fl_x", "camera_angle_x"}, [](Json& j) { j.erase("fl_x"), j.erase("fl_y"); }},
      {{"/camera_angle_x: ", " 4 "}, [](Json& j) { j.erase("fl_x"), j["camera_angle_x"] = 4; }},
      {{"/frames/0: ", "size"}, [](Json& j) { j.erase("w"); }},
      {{"/w: ", "1.5"}, [](Json& j) { j["w"] = 1.5; }},
      {{"/camera_model: ", "TELESCOPE"}, [](Json& j) { j["camera_model"] = "TELESCOPE"; }},
      {{"/k4: ", "OPENCV"}, [](Json& j) { j["k4"] = 0.1; }},
      {{"/k1: "}, [](Json& j) { j["k1"] = "none"; }},
  };
  for (const Spoilt& spoilt : cases) {
    Json json = example();
    spoilt.spoil(json);
    INFO(test::jsonLine(json));
    const std::string fault = faultOf(test::jsonLine(json));
    for (const char* token : spoilt.tokens) CHECK_THAT(fault, Contains(token));
  }
  std::string nan = test::jsonLine(example());
  nan.replace(nan.find("500"), 3, "NaN");
  CHECK_THAT(faultOf(nan), Contains("line 1"));
  // Rounding errors are accepted.
  Json rounded = example();
  rounded["frames"][0]["transform_matrix"][0][0] = 1.0005;
  rounded["frames"][0]["transform_matrix"][0][1] = 0.0005;
  CHECK(glm::length(read(rounded).images[1].camera.pose.rotation) == Approx(1).epsilon(1e-15));
}
