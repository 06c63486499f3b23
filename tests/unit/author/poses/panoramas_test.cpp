// SPDX-License-Identifier: Apache-2.0
// Panoramas with poses: panoramas.json, and COLMAP models with EQUIRECTANGULAR cameras.
#include <catch2/catch.hpp>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numbers>

#include "base/file.h"
#include "ibr/author/build.h"
#include "ibr/error.h"
#include "io/image_file.h"
#include "lab/generate/synthetic.h"
#include "support/temporary_folder.h"

namespace fs = std::filesystem;
using namespace ibr;
using Catch::Contains;

namespace {

// The second panorama looks along world x: z forward = +x, x right = −y, y down = −z, with world z up.
const std::string kFile = R"({
 "convention": "in words",
 "width": 64, "height": 32,
 "panoramas": [
  {"name": "images/b.png", "position": [1, 2, 3], "R_world_to_camera": [[1, 0, 0], [0, 0, -1], [0, 1, 0]]},
  {"name": "images/a.png", "position": [0, 0, 1.5], "R_world_to_camera": [[0, -1, 0], [0, 0, -1], [1, 0, 0]],
   "q_world_to_camera_wxyz": [0.5, 0.5, -0.5, 0.5], "t_world_to_camera": [0, 1.5, 0]},
  {"name": "images/c.png", "q_world_to_camera_wxyz": [1, 0, 0, 0], "t_world_to_camera": [-4, -5, -6]}],
 "triangles": [[0, 1, 2]]
})";

PosedModel read(const std::string& text) {
  const test::TemporaryFolder folder;
  writeFile(folder / "panoramas.json", text);
  return readPanoramas(folder / "panoramas.json");
}

std::string with(const std::string& what, const std::string& instead) {
  std::string text = kFile;
  REQUIRE(text.find(what) != text.npos);
  return text.replace(text.find(what), what.size(), instead);
}

// Returns the pixel at which a panorama sees a world point.
glm::dvec2 seen(const PosedImage& image, glm::dvec3 point) {
  const Camera& camera = image.camera;
  return project(camera.intrinsics, glm::conjugate(camera.pose.rotation) * (point - camera.pose.position)).value();
}

}  // namespace

TEST_CASE("panoramas.json is converted to libibr's axes and sorted by name") {
  const PosedModel model = read(kFile);
  REQUIRE(model.images.size() == 3);
  CHECK(model.tracks.empty());
  CHECK(model.images[0].name == "images/a.png");
  CHECK(model.images[2].name == "images/c.png");
  for (const PosedImage& image : model.images)
    CHECK(image.camera.intrinsics == Intrinsics{CameraModel::equirectangular, 64, 32});
  CHECK(model.images[0].camera.pose.position == glm::dvec3(0, 0, 1.5));
  CHECK(model.images[1].camera.pose.position == glm::dvec3(1, 2, 3));
  CHECK(glm::distance(model.images[2].camera.pose.position, glm::dvec3(4, 5, 6)) < 1e-12);
  // The middle of the picture looks forward, the top row looks up, and a quarter further looks to the right.
  const PosedImage& a = model.images[0];
  CHECK(glm::distance(seen(a, {5, 0, 1.5}), glm::dvec2(32, 16)) < 1e-9);
  CHECK(glm::distance(seen(a, {0, -5, 1.5}), glm::dvec2(48, 16)) < 1e-9);
  CHECK(seen(a, {0, 0, 9}).y == Approx(0).margin(1e-9));
  CHECK(seen(a, {0, 0, -9}).y == Approx(32));
  CHECK(glm::distance(seen(a, {1, 0, 2.5}), glm::dvec2(32, 8)) < 1e-9);
  // Axes of the file format: forward is camera (0, 0, 1), y points down.
  CHECK(glm::distance(seen(model.images[2], {4, 5 + 1, 6 + 1}), glm::dvec2(32, 24)) < 1e-9);
}

TEST_CASE("a malformed panoramas.json is rejected with the JSON pointer of the fault") {
  struct Row {
    std::string text;
    std::vector<const char*> tokens;  // of the message
  };
  const Row rows[] = {
      {"{", {"JSON"}},
      {"[]", {"object"}},
      {with("\"width\": 64", "\"width\": 0"), {"/width", "65536"}},
      {with("\"width\": 64, ", ""), {"\"width\""}},
      {with("\"height\": 32", "\"height\": 32.5"), {"/height", "32.5"}},
      {with("\"panoramas\"", "\"panorama\""), {"\"panoramas\""}},
      {R"({"width": 4, "height": 2, "panoramas": []})", {"/panoramas: "}},
      {with("images/b.png", ""), {"/panoramas/0/name"}},
      {with("images/b.png", "images/a.png"), {"/panoramas/1/name", "images/a.png"}},
      {with("\"position\": [1, 2, 3], ", ""), {"/panoramas/0: ", "position", "t_world_to_camera"}},
      {with("[1, 2, 3]", "[1, 2]"), {"/panoramas/0/position: ", " 2 "}},
      {with("[1, 2, 3]", "[1, 2, \"x\"]"), {"/panoramas/0/position/2", "\"x\""}},
      {with("[1, 2, 3]", "[1, 2, 1e999]"), {"JSON"}},
      {with("\"q_world_to_camera_wxyz\": [1, 0, 0, 0], ", ""),
       {"/panoramas/2: ", "R_world_to_camera", "q_world_to_camera_wxyz"}},
      {with("[1, 0, 0, 0]", "[2, 0, 0, 0]"), {"/panoramas/2/q_world_to_camera_wxyz: ", "length", " 2"}},
      {with("[1, 0, 0, 0]", "[1, 0, 0]"), {"/panoramas/2/q_world_to_camera_wxyz: ", " 3 "}},
      {with("[[1, 0, 0], ", "["), {"/panoramas/0/R_world_to_camera: ", " 2 "}},
      {with("[[1, 0, 0], ", "[[1.01, 0, 0], "), {"/panoramas/0/R_world_to_camera: ", "orthonormal"}},
      {with("[[1, 0, 0], ", "[[-1, 0, 0], "), {"/panoramas/0/R_world_to_camera: ", "determinant"}},
      {with("[0.5, 0.5, -0.5, 0.5]", "[0.5, 0.5, 0.5, 0.5]"),
       {"/panoramas/1/q_world_to_camera_wxyz: ", "\"R_world_to_camera\""}},
      {with("[0, 1.5, 0]", "[0, 1.6, 0]"), {"/panoramas/1/t_world_to_camera: ", "\"position\""}},
      {with("[[0, 1, 2]]", "[[0, 1, 3]]"), {"/triangles/0/2: ", "3"}},
      {with("[[0, 1, 2]]", "[[0, 1]]"), {"/triangles/0: ", " 2 "}},
  };
  for (const Row& row : rows) {
    INFO(row.text);
    try {
      read(row.text);
      FAIL_CHECK("was read");
    } catch (const Error& error) {
      CHECK(error.code() == ErrorCode::invalidInput);
      CHECK_THAT(error.what(), Contains("panoramas.json"));
      for (const char* token : row.tokens) CHECK_THAT(error.what(), Contains(token));
    }
  }
  try {
    readPanoramas("/nowhere/panoramas.json");
    FAIL("was read");
  } catch (const Error& error) {
    CHECK(error.code() == ErrorCode::io);
  }
}

TEST_CASE("rounded rotations are normalised, and optional fields may be missing") {
  const PosedModel model = read(with("[[1, 0, 0], [0, 0, -1]", "[[1.0003, 0, 0], [0, 0.0002, -1]"));
  CHECK(glm::length(model.images[1].camera.pose.rotation) == Approx(1).epsilon(1e-12));
  CHECK(read(with(",\n \"triangles\": [[0, 1, 2]]", "")).images.size() == 3);
}

TEST_CASE("COLMAP models with EQUIRECTANGULAR cameras are read, text and binary") {
  const std::string images = "1 1 0 0 0 0 0 0 1 a.jpg\n32 16 7 48 16 8\n";
  const std::string points = "7 0 0 5 0 0 0 0.1 1 0\n8 3 0 0 0 0 0 0.1 1 1\n";
  const auto text = [&](const std::string& camera) {
    const test::TemporaryFolder folder;
    writeFile(folder / "cameras.txt", camera);
    writeFile(folder / "images.txt", images);
    writeFile(folder / "points3D.txt", points);
    return readColmapModel(folder.path());
  };
  const auto checkModel = [](const PosedModel& model) {
    REQUIRE(model.images.size() == 1);
    CHECK(model.images[0].camera.intrinsics == Intrinsics{CameraModel::equirectangular, 64, 32});
    REQUIRE(model.tracks.size() == 2);
    for (const Track& track : model.tracks)
      CHECK(glm::distance(seen(model.images[0], track.position), track.observations.at(0).pixel) < 1e-9);
  };
  checkModel(text("1 EQUIRECTANGULAR 64 32\n"));
  checkModel(text("1 EQUIRECTANGULAR 64 32 64 32\n"));
  CHECK_THROWS_WITH(text("1 EQUIRECTANGULAR 64 32 64\n"), Contains("cameras.txt:1") && Contains("1 PARAMS"));
  CHECK_THROWS_WITH(text("1 EQUIRECTANGULAR 64 32 128 64\n"),
                    Contains("cameras.txt:1") && Contains("128x64") && Contains("64x32"));
  CHECK_THROWS_WITH(text("1 EQUIRECTANGULAR 0 32\n"), Contains("cameras.txt:1") && Contains("0x32"));

  const auto binary = [&](std::int32_t number) {
    std::string cameras, records, all;
    const auto put = [](std::string& to, auto value) {
      to.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    put(cameras, std::uint64_t(1));
    put(cameras, std::uint32_t(1));
    put(cameras, number);
    put(cameras, std::uint64_t(64));
    put(cameras, std::uint64_t(32));
    put(cameras, 64.0);
    put(cameras, 32.0);
    put(records, std::uint64_t(1));
    put(records, std::uint32_t(1));
    for (const double v : {1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0}) put(records, v);
    put(records, std::uint32_t(1));
    records += std::string("a.jpg\0", 6);
    put(records, std::uint64_t(2));
    for (const double x : {32.0, 48.0}) {
      put(records, x);
      put(records, 16.0);
      put(records, std::uint64_t(x == 32.0 ? 7 : 8));
    }
    put(all, std::uint64_t(2));
    for (const std::uint64_t id : {7u, 8u}) {
      put(all, id);
      for (const double v : {id == 7 ? 0.0 : 3.0, 0.0, id == 7 ? 5.0 : 0.0}) put(all, v);
      all += std::string(3, '\0');
      put(all, 0.1);
      put(all, std::uint64_t(0));
    }
    const test::TemporaryFolder folder;
    writeFile(folder / "cameras.bin", cameras);
    writeFile(folder / "images.bin", records);
    writeFile(folder / "points3D.bin", all);
    return readColmapModel(folder.path());
  };
  checkModel(binary(17));
  CHECK_THROWS_WITH(binary(11), Contains("cameras.bin") && Contains("MODEL 11"));
  CHECK_THROWS_WITH(binary(-1), Contains("cameras.bin") && Contains("MODEL -1"));
}

TEST_CASE("build finds the images of panoramas and makes one cell of three") {
  const test::TemporaryFolder folder;
  writeFile(folder / "panoramas.json", R"({"width": 256, "height": 128, "panoramas": [
    {"name": "images/a.png", "position": [0, 0, 0], "q_world_to_camera_wxyz": [1, 0, 0, 0]},
    {"name": "images/b.png", "position": [1, 0, 0], "q_world_to_camera_wxyz": [0, 0, 1, 0]},
    {"name": "images/c.png", "position": [0.4, 0, 0.8], "q_world_to_camera_wxyz": [1, 0, 0, 0]}]})");
  BuildOptions options;
  options.photographs = folder.path();
  options.model = folder / "panoramas.json";
  options.output = folder / "scene";
  const auto codeAndMessage = [&] {
    try {
      build(options);
    } catch (const Error& error) {
      return std::pair(error.code(), std::string(error.what()));
    }
    return std::pair(ErrorCode::cancelled, std::string("was built"));
  };
  CHECK(codeAndMessage().first == ErrorCode::io);
  CHECK_THAT(codeAndMessage().second, Contains("images/a.png"));

  SyntheticOptions room;
  room.planes = roomPlanes({-3, -2, -3}, {4, 2, 4}, 0.5);
  room.surfaceStep = 2;
  const PosedModel model = readPanoramas(options.model);
  for (const PosedImage& image : model.images) room.cameras.push_back(image.camera);
  const SyntheticScene truth = makeScene(room);
  fs::create_directories(folder / "images");
  for (std::size_t i = 0; i < model.images.size(); ++i) writeImage(folder / model.images[i].name, truth.photographs[i]);
  const BuildReport report = build(options);
  CHECK(report.cells.size() == 1);
  const Scene scene = loadScene(options.output);
  CHECK(scene.acquisition == "panoramic");
  REQUIRE(scene.cells.size() == 1);
  CHECK(scene.cells[0].members.size() == 3);
  CHECK(scene.cells[0].quality.coverage > 0.5);
  CHECK(validateSceneFiles(options.output).empty());

  writeImage(folder / "images/b.png", Image8(64, 64, 3, 90));
  CHECK(codeAndMessage().first == ErrorCode::invalidInput);
}
