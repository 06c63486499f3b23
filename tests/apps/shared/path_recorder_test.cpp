// SPDX-License-Identifier: Apache-2.0
#include "shared/camera/path_recorder.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "ibr/error.h"
#include "support/temporary_folder.h"

using namespace ibr;
using namespace ibr::app;

namespace {

CameraPath empty() {
  return {64, 48, 30, {}};
}

CameraKey keyAt(double time, glm::dvec3 position, double turn = 0) {
  return {time, position, glm::angleAxis(turn, glm::normalize(glm::dvec3(0.1, 1, 0.2))), 0.8};
}

std::vector<double> timesOf(const CameraPath& path) {
  std::vector<double> times;
  for (const CameraKey& key : path.keys) times.push_back(key.time);
  return times;
}

// A curved path with uneven steps.
CameraPath bent() {
  CameraPath path = empty();
  double time = 1;
  for (const glm::dvec3 p : {glm::dvec3(0, 0, 0), {1, 0, 0}, {1.5, 1, 0}, {4, 1, -2}, {4.2, 1, -2}}) {
    putKey(path, keyAt(time, p, 0.3 * p.y));
    time += 1;
  }
  return path;
}

double wayFrom(const CameraPath& path, double from, double to) {
  double way = 0;
  Pose last = cameraAt(path, from).pose;
  for (int i = 1; i <= 200; ++i) {
    const Pose pose = cameraAt(path, std::lerp(from, to, i / 200.0)).pose;
    way += poseDistance(last, pose, unitsPerRadianOf(path));
    last = pose;
  }
  return way;
}

}  // namespace

TEST_CASE("keys can be inserted in order, replaced, moved and deleted") {
  CameraPath path = empty();
  CHECK(putKey(path, keyAt(2, {2, 0, 0})) == 0);
  CHECK(putKey(path, keyAt(0, {0, 0, 0})) == 0);
  CHECK(putKey(path, keyAt(1, {1, 0, 0})) == 1);
  CHECK(putKey(path, keyAt(1.0004, {5, 0, 0})) == 1);
  CHECK(timesOf(path) == std::vector<double>{0, 1.0004, 2});
  CHECK(path.keys[1].position.x == 5);
  CHECK(moveKey(path, 1, 7) == 2);
  CHECK(timesOf(path) == std::vector<double>{0, 2, 7});
  CHECK(path.keys[2].position.x == 5);
  CHECK(moveKey(path, 2, 7) == 2);
  deleteKey(path, 1);
  CHECK(timesOf(path) == std::vector<double>{0, 7});
  deleteKey(path, 0);
  deleteKey(path, 0);
  CHECK(path.keys.empty());
}

TEST_CASE("changes that make a path invalid are refused and leave the path unchanged") {
  CameraPath path = bent();
  const double nan = std::nan("");
  const auto refused = [&](auto&& change) {
    const std::vector<double> before = timesOf(path);
    try {
      change();
      FAIL_CHECK("nothing was thrown");
    } catch (const Error& e) {
      CHECK(e.code() == ErrorCode::invalidInput);
    }
    CHECK(timesOf(path) == before);
  };
  refused([&] { putKey(path, keyAt(nan, {})); });
  refused([&] { putKey(path, keyAt(1e9, {})); });
  refused([&] { putKey(path, keyAt(50000, {})); });  // over a million frames
  refused([&] { putKey(path, keyAt(9, {nan, 0, 0})); });
  refused([&] { putKey(path, {9, {}, {nan, 0, 0, 0}, 0.8}); });
  refused([&] { putKey(path, {9, {}, {0, 0, 0, 0}, 0.8}); });
  refused([&] { putKey(path, {9, {}, {1, 0, 0, 0}, 3.15}); });
  refused([&] { putKey(path, {9, {}, {1, 0, 0, 0}, 0}); });
  refused([&] { moveKey(path, 0, 2); });
  refused([&] { moveKey(path, 0, nan); });
  refused([&] { moveKey(path, 5, 9); });
  refused([&] { deleteKey(path, 5); });
  refused([&] { retimeAtSpeed(path, 0); });
  refused([&] { retimeAtSpeed(path, nan); });
  refused([&] { retimeAtSpeed(path, 1e-9); });  // longer than a day
  refused([&] { retimeToLast(path, 0); });
  refused([&] { retimeToLast(path, 1e9); });
  refused([&] { appendKey(path, {{1e300, 0, 0}, {1, 0, 0, 0}}, 1, 1); });
  refused([&] { appendKey(path, {}, 1, nan); });
}

TEST_CASE("an appended key's time follows from its distance and the speed") {
  CameraPath path = empty();
  const glm::dquat still(1, 0, 0, 0);
  CHECK(appendKey(path, {{0, 0, 0}, still}, 1, 2) == 0);
  CHECK(appendKey(path, {{3, 0, 0}, still}, 1, 2) == 1);
  CHECK(path.keys[1].time == Approx(1.5));
  appendKey(path, {{3, 0, 0}, still}, 1, 2);  // without motion: one frame
  CHECK(path.keys[2].time == Approx(1.5 + 1.0 / 30));
  appendKey(path, {{3, 0, 0}, glm::angleAxis(0.5, glm::dvec3(0, 1, 0))}, 1, 2);
  CHECK(path.keys[3].time - path.keys[2].time == Approx(1.5));  // half a radian takes as long as the step
}

TEST_CASE("after re-timing, the camera has the same speed between all keys") {
  CameraPath path = bent();
  const CameraPath before = path;
  retimeAtSpeed(path, 0.5);
  CHECK(path.keys[0].time == 1);
  for (std::size_t i = 0; i + 1 < path.keys.size(); ++i) {
    const double from = path.keys[i].time, to = path.keys[i + 1].time;
    CHECK(wayFrom(path, from, to) / (to - from) == Approx(0.5).epsilon(0.01));
    CHECK(path.keys[i].position == before.keys[i].position);
    CHECK(path.keys[i].rotation == before.keys[i].rotation);
  }
  retimeToLast(path, 12);
  CHECK(path.keys.back().time - path.keys.front().time == Approx(12).epsilon(1e-3));
  const double speed = wayFrom(path, path.keys[0].time, path.keys[1].time) / (path.keys[1].time - path.keys[0].time);
  for (std::size_t i = 1; i + 1 < path.keys.size(); ++i)
    CHECK(wayFrom(path, path.keys[i].time, path.keys[i + 1].time) / (path.keys[i + 1].time - path.keys[i].time) ==
          Approx(speed).epsilon(0.01));
}

TEST_CASE("re-timing keeps pauses, and leaves paths without motion valid") {
  CameraPath path = empty();
  for (const auto& [time, x] : {std::pair{0.0, 0.0}, {1.0, 1.0}, {4.0, 1.0}, {5.0, 2.0}})
    putKey(path, keyAt(time, {x, 0, 0}));
  retimeAtSpeed(path, 2);
  CHECK(path.keys[2].time - path.keys[1].time == Approx(3));
  const double whole = path.keys.back().time;
  retimeToLast(path, 2 * whole);
  CHECK(path.keys[2].time - path.keys[1].time == Approx(6));
  CHECK(path.keys.back().time == Approx(2 * whole));

  CameraPath still = empty();
  putKey(still, keyAt(0, {1, 2, 3}));
  retimeAtSpeed(still, 1);
  retimeToLast(still, 4);
  CHECK(timesOf(still) == std::vector<double>{0});
  putKey(still, keyAt(2, {1, 2, 3}));
  retimeAtSpeed(still, 1);
  CHECK(timesOf(still) == std::vector<double>{0, 2});
  retimeToLast(still, 4);
  CHECK(timesOf(still) == std::vector<double>{0, 4});
  CameraPath none = empty();
  retimeAtSpeed(none, 1);
  retimeToLast(none, 1);
  CHECK(none.keys.empty());
}

TEST_CASE("a saved path plays exactly as recorded") {
  const test::TemporaryFolder folder;
  CameraPath path = bent();
  putKey(path, {6.7, {1e6 + 1.0 / 3, 2.0 / 7, -1e-9}, glm::normalize(glm::dquat(0.3, -0.1, 0.9, 0.20001)), 1.1});
  retimeAtSpeed(path, 1e5);
  writeCameraPath(folder / "path.json", path);
  const CameraPath read = readCameraPath(folder / "path.json");
  const auto shown = frames(path), played = frames(read);
  REQUIRE(shown.size() == played.size());
  REQUIRE(shown.size() > 100);
  for (std::size_t i = 0; i < shown.size(); ++i) {
    REQUIRE(shown[i].camera.pose.position == played[i].camera.pose.position);
    REQUIRE(shown[i].camera.pose.rotation == played[i].camera.pose.rotation);
    REQUIRE(shown[i].camera.intrinsics == played[i].camera.intrinsics);
  }
  for (const CameraKey& key : path.keys) {  // the camera at a key equals the key's view bit for bit
    const Camera camera = cameraAt(read, key.time);
    CHECK(camera.pose.position == key.position);
    CHECK(camera.pose.rotation == key.rotation);
  }
}
