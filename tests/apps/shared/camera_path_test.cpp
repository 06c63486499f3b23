// SPDX-License-Identifier: Apache-2.0
#include "shared/camera/camera_path.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "base/file.h"
#include "ibr/error.h"
#include "support/temporary_folder.h"

using namespace ibr;
using namespace ibr::app;

namespace {

glm::dquat turnedY(double angle) {
  return glm::angleAxis(angle, glm::dvec3(0, 1, 0));
}

// A path irregular in time, position and rotation.
CameraPath bentPath() {
  return {64,
          48,
          25,
          {{0.0, {0, 0, 0}, turnedY(0.0), 0.8},
           {0.7, {1, 0.5, 0}, turnedY(0.6), 1.0},
           {1.0, {1.5, -0.5, 2}, turnedY(0.9), 1.1},
           {3.0, {4, 0, 2}, turnedY(2.5), 0.7}}};
}

}  // namespace

TEST_CASE("the curve passes through every key") {
  CameraPath path = bentPath();
  path.keys[2].rotation = -path.keys[2].rotation;  // the same rotation
  for (const CameraKey& key : path.keys) {
    const Camera camera = cameraAt(path, key.time);
    CHECK(glm::distance(camera.pose.position, key.position) < 1e-12);
    CHECK(angleBetween(camera.pose.rotation, key.rotation) < 1e-6);
    CHECK(camera.intrinsics.fy == Approx(0.5 * 48 / std::tan(0.5 * key.fovY)));
    CHECK((camera.intrinsics.width == 64 && camera.intrinsics.height == 48));
    CHECK((camera.intrinsics.cx == 32 && camera.intrinsics.cy == 24));
  }
}

TEST_CASE("the velocity is continuous at keys") {
  const CameraPath path = bentPath();
  const auto speed = [&](double from, double to) {
    return (cameraAt(path, to).pose.position - cameraAt(path, from).pose.position) / (to - from);
  };
  constexpr double kStep = 1e-6;
  for (const std::size_t i : {1, 2}) {
    const double t = path.keys[i].time;
    CHECK(glm::distance(speed(t - kStep, t), speed(t, t + kStep)) < 1e-4);
    const auto turned = [&](double from, double to) {
      return angleBetween(cameraAt(path, from).pose.rotation, cameraAt(path, to).pose.rotation) / (to - from);
    };
    CHECK(turned(t - 1e-4, t) == Approx(turned(t, t + 1e-4)).epsilon(0.01));
  }
}

TEST_CASE("evenly spaced keys on a straight line give uniform motion") {
  CameraPath path{64, 48, 30, {}};
  for (int i = 0; i < 5; ++i) path.keys.push_back({double(i), {2.0 * i, 1.0 * i, -3.0 * i}, turnedY(0.1 * i), 1.0});
  for (double t = 0; t <= 4; t += 0.13)
    CHECK(glm::distance(cameraAt(path, t).pose.position, glm::dvec3(2, 1, -3) * t) < 1e-12);
  // Also with irregular key times, because the tangents account for time.
  path.keys.erase(path.keys.begin() + 1);
  for (double t = 0; t <= 4; t += 0.13)
    CHECK(glm::distance(cameraAt(path, t).pose.position, glm::dvec3(2, 1, -3) * t) < 1e-12);
}

TEST_CASE("rotations are interpolated the short way for any signs of their quaternions") {
  CameraPath path{64, 48, 30, {{0, {}, turnedY(0.0), 1}, {1, {}, turnedY(1.0), 1}, {2, {}, turnedY(2.0), 1}}};
  for (int signs = 0; signs < 8; ++signs) {
    CameraPath flipped = path;
    for (std::size_t i = 0; i < 3; ++i)
      if (signs >> i & 1) flipped.keys[i].rotation = -flipped.keys[i].rotation;
    for (double t = 0; t <= 2; t += 0.1) {
      INFO("signs " << signs << " t " << t);
      const glm::dquat rotation = cameraAt(flipped, t).pose.rotation;
      CHECK(glm::length(rotation) == Approx(1.0).margin(1e-12));
      CHECK(angleBetween(rotation, turnedY(t)) < 0.02);
      CHECK(angleBetween(rotation, cameraAt(path, t).pose.rotation) < 1e-6);
    }
  }
}

TEST_CASE("the field of view stays between the values of its keys") {
  CameraPath path{64, 48, 30, {}};
  const double fov[] = {0.5, 0.5, 3.0, 3.0, 0.5};
  for (int i = 0; i < 5; ++i) path.keys.push_back({double(i), {}, turnedY(0), fov[i]});
  for (double t = 0; t <= 4; t += 0.01) {
    const double fovY = 2 * std::atan(24 / cameraAt(path, t).intrinsics.fy);
    CHECK((fovY >= 0.5 - 1e-9 && fovY <= 3.0 + 1e-9));
  }
}

TEST_CASE("frames go from the first key to the last") {
  CameraPath path = bentPath();
  const auto views = frames(path);
  REQUIRE(views.size() == 76);  // 3 s at 25 frames a second, both ends included
  CHECK(views.front().name == "frame_0000");
  CHECK(views.back().name == "frame_0075");
  CHECK(glm::distance(views.back().camera.pose.position, path.keys.back().position) < 1e-9);
  path.keys.resize(1);
  CHECK(frames(path).size() == 1);
  // Before the first key and after the last, the camera does not move.
  CHECK(cameraAt(bentPath(), -5).pose.position == bentPath().keys.front().position);
  CHECK(glm::distance(cameraAt(bentPath(), 50).pose.position, bentPath().keys.back().position) < 1e-12);
}

TEST_CASE("a camera path round trips through its file") {
  test::TemporaryFolder folder;
  const CameraPath path = bentPath();
  writeCameraPath(folder / "path.json", path);
  const CameraPath again = readCameraPath(folder / "path.json");
  CHECK((again.width == path.width && again.height == path.height && again.fps == path.fps));
  REQUIRE(again.keys.size() == path.keys.size());
  for (std::size_t i = 0; i < path.keys.size(); ++i) {
    CHECK(again.keys[i].time == path.keys[i].time);
    CHECK(again.keys[i].position == path.keys[i].position);
    CHECK(angleBetween(again.keys[i].rotation, path.keys[i].rotation) < 1e-7);
    CHECK(again.keys[i].fovY == path.keys[i].fovY);
  }
}

TEST_CASE("errors in a camera path's file name the field") {
  test::TemporaryFolder folder;
  const std::string key = R"({"time":0,"position":[0,0,0],"rotation":[0,0,0,1],"fovY":1})";
  const auto file = [&](const std::string& size, const std::string& fps, const std::string& keys) {
    return R"({"version":1,"size":)" + size + R"(,"fps":)" + fps + R"(,"keys":)" + keys + "}";
  };
  const auto replaced = [&](const std::string& what, const std::string& by) {
    std::string text = key;
    text.replace(text.find(what), what.size(), by);
    return file("[8,8]", "30", "[" + text + "]");
  };
  const std::pair<std::string, std::string> cases[] = {
      {"", "JSON"},
      {"[1,2", "JSON"},
      {"[]", "\"version\""},
      {R"({"version":2})", "/version"},
      {file("[8]", "30", "[" + key + "]"), "/size"},
      {file("[8,0]", "30", "[" + key + "]"), "/size/1"},
      {file("[8,4294967304]", "30", "[" + key + "]"), "/size/1"},
      {file("[8,3.5]", "30", "[" + key + "]"), "/size/1"},
      {file("[8,8]", "0", "[" + key + "]"), "/fps"},
      {file("[8,8]", "\"30\"", "[" + key + "]"), "/fps"},
      {file("[8,8]", "30", "[]"), "/keys"},
      {file("[8,8]", "30", "[" + key + "," + key + "]"), "/keys/1/time"},
      {replaced("[0,0,0]", "[0,0]"), "/keys/0/position"},
      {replaced("[0,0,0]", "[0,0,1e300]"), "/keys/0/position/2"},
      {replaced("[0,0,0]", "[0,0,1e999]"), "JSON"},
      {replaced("[0,0,0,1]", "[0,0,0,0]"), "/keys/0/rotation"},
      {replaced("[0,0,0,1]", "[0,0,0.5,1]"), "/keys/0/rotation"},
      {replaced("\"fovY\":1", "\"fovY\":60"), "/keys/0/fovY"},
      {replaced("\"fovY\":1", "\"fovY\":null"), "/keys/0/fovY"},
      {replaced("\"fovY\":1", "\"fovy\":1"), "\"fovY\""},
      {replaced("\"fovY\":1", "\"fovY\":1,\"fovY\":2"), "\"fovY\""},
      {std::string(100000, '['), "path.json"},
  };
  for (const auto& [text, place] : cases) {
    INFO(text.substr(0, 200));
    writeFile(folder / "path.json", text);
    try {
      readCameraPath(folder / "path.json");
      FAIL_CHECK("nothing was thrown");
    } catch (const Error& e) {
      CHECK(e.code() == ErrorCode::invalidInput);
      CHECK_THAT(e.what(), Catch::Contains("path.json") && Catch::Contains(place));
    }
  }
}
