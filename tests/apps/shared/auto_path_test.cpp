// SPDX-License-Identifier: Apache-2.0
#include "shared/camera/auto_path.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <random>

#include "ibr/error.h"

using namespace ibr;
using namespace ibr::app;

namespace {

Node nodeAt(glm::dvec3 position, glm::dquat rotation = {1, 0, 0, 0}) {
  Node node;
  node.camera = {pinholeFromFov(640, 480, 1.0), {position, rotation}};
  return node;
}

// Nodes in a row, in shuffled order.
Scene row(int count) {
  Scene scene;
  for (int i = 0; i < count; ++i) scene.nodes.push_back(nodeAt({(i * 7 % count) * 1.0, 0, 0}));
  return scene;
}

Cell cellOf(std::vector<std::uint32_t> members, double coverage) {
  Cell cell;
  cell.members = std::move(members);
  cell.quality.coverage = coverage;
  return cell;
}

bool isRotation(glm::dquat q) {
  return std::abs(glm::length(q) - 1) < 1e-9;
}

}  // namespace

TEST_CASE("the path follows a row of photographs and extends it by a tenth of a step at both ends") {
  const Scene scene = row(9);
  const auto views = frames(autoPath(scene, 60));
  REQUIRE(views.size() == 60);
  const double begin = views.front().camera.pose.position.x, end = views.back().camera.pose.position.x;
  CHECK(std::min(begin, end) == Approx(-0.1).margin(0.05));
  CHECK(std::max(begin, end) == Approx(8.1).margin(0.05));
  for (std::size_t i = 1; i < views.size(); ++i) {
    const double step = views[i].camera.pose.position.x - views[i - 1].camera.pose.position.x;
    CHECK(step * (end - begin) > 0);                         // never backwards
    CHECK(std::abs(step) < 3 * std::abs(end - begin) / 59);  // no jumps
    CHECK(glm::dot(viewAxis(views[i].camera.pose), glm::dvec3(0, 0, -1)) > 0.999);
  }
}

TEST_CASE("the path has the requested number of frames") {
  for (const int count : {1, 2, 3, 30, 91, 1000}) CHECK(frames(autoPath(row(5), count)).size() == std::size_t(count));
}

TEST_CASE("the path through a grid is less than 1.3 times the shortest tour") {
  Scene scene;
  for (int i = 0; i < 30; ++i) scene.nodes.push_back(nodeAt({double(i * 11 % 30 % 6), double(i * 11 % 30 / 6), 0}));
  const auto views = frames(autoPath(scene, 300));
  double length = 0;
  for (std::size_t i = 1; i < views.size(); ++i)
    length += glm::distance(views[i].camera.pose.position, views[i - 1].camera.pose.position);
  CHECK(length < 1.3 * 29);  // the shortest tour has 29 steps of length 1
}

TEST_CASE("the field of view is 0.9 of the photographs' for any aspect ratio") {
  const auto tangents = [](const Camera& camera) {
    const Intrinsics& k = camera.intrinsics;
    return glm::dvec2(0.5 * k.width / k.fx, 0.5 * k.height / k.fy);
  };
  const Scene scene = row(4);
  const glm::dvec2 photograph = tangents(scene.nodes[0].camera);
  const std::pair<int, int> sizes[] = {{0, 0}, {1920, 1080}, {400, 800}};
  for (const auto& [width, height] : sizes) {
    const Camera camera = frames(autoPath(scene, 3, width, height))[1].camera;
    const glm::dvec2 view = tangents(camera);
    CHECK((view.x < photograph.x && view.y < photograph.y));
    CHECK(std::max(view.x / photograph.x, view.y / photograph.y) == Approx(0.9));
    if (width) CHECK((camera.intrinsics.width == width && camera.intrinsics.height == height));
  }
  const Camera camera = frames(autoPath(scene, 1))[0].camera;
  CHECK((camera.intrinsics.width == 640 && camera.intrinsics.height == 480));
}

TEST_CASE("at positions with several photographs the path follows the one that turns the view least") {
  Scene scene;
  for (int i = 0; i < 5; ++i)
    for (int direction = 0; direction < 4; ++direction)
      scene.nodes.push_back(nodeAt({double(i), 0, 0}, glm::angleAxis(direction * 1.5707963, glm::dvec3(0, 1, 0))));
  const auto views = frames(autoPath(scene, 50));
  for (std::size_t i = 1; i < views.size(); ++i)
    CHECK(glm::dot(viewAxis(views[i].camera.pose), viewAxis(views[0].camera.pose)) > 0.999);
}

TEST_CASE("a drone that turns its heading does not roll the view") {
  Scene scene;
  const glm::dquat down = glm::angleAxis(-1.5707963, glm::dvec3(1, 0, 0));
  for (int i = 0; i < 12; ++i) {
    const bool back = i / 4 % 2 == 1;
    scene.nodes.push_back(nodeAt({double(back ? 3 - i % 4 : i % 4), 0, double(i / 4)},
                                 glm::angleAxis(back ? 3.14159265 : 0.0, glm::dvec3(0, 1, 0)) * down));
  }
  const auto views = frames(autoPath(scene, 80));
  for (std::size_t i = 1; i < views.size(); ++i) {
    CHECK(isRotation(views[i].camera.pose.rotation));
    CHECK(std::abs(glm::dot(views[i].camera.pose.rotation, views[0].camera.pose.rotation)) > 0.999);
  }
}

TEST_CASE("walking around an object keeps it in view and the horizon level") {
  Scene scene;
  for (int i = 0; i < 16; ++i) {
    const double angle = i * 5 % 16 * 2 * 3.14159265 / 16;
    scene.nodes.push_back(
        nodeAt({3 * std::sin(angle), 0.1 * (i % 2), 3 * std::cos(angle)}, glm::angleAxis(angle, glm::dvec3(0, 1, 0))));
  }
  for (const View& view : frames(autoPath(scene, 100))) {
    const Pose& pose = view.camera.pose;
    CHECK(glm::dot(viewAxis(pose), glm::normalize(-pose.position)) > 0.95);
    CHECK((pose.rotation * glm::dvec3(0, 1, 0)).y > 0.99);
    CHECK(std::abs((pose.rotation * glm::dvec3(1, 0, 0)).y) < 0.02);
  }
}

TEST_CASE("if a scene has cells, the path visits only photographs of cells") {
  Scene scene = row(5);
  scene.nodes.push_back(nodeAt({0, 500, 0}));
  Cell cell;
  cell.members = {0, 1, 2};
  scene.cells.push_back(cell);
  for (const View& view : frames(autoPath(scene, 40))) CHECK(view.camera.pose.position.y == 0);
}

TEST_CASE("the path leads through the middle of cells") {
  // Two rows of photographs, joined to triangles: the walk stays between the rows.
  Scene scene;
  for (int i = 0; i < 12; ++i) scene.nodes.push_back(nodeAt({double(i / 2), double(i % 2), 0}));
  for (std::uint32_t i = 0; i + 2 < 12; ++i) scene.cells.push_back(cellOf({i, i + 1, i + 2}, 0.81));
  const auto views = frames(autoPath(scene, 80));
  for (const View& view : views) {
    CHECK(view.camera.pose.position.y > 0.2);
    CHECK(view.camera.pose.position.y < 0.8);
  }
  CHECK(views.front().camera.pose.position.x < 0);  // ends slightly beyond both ends of the rows
  CHECK(views.front().camera.pose.position.x > -0.3);
  CHECK(views.back().camera.pose.position.x > 5);
  CHECK(views.back().camera.pose.position.x < 5.3);
}

TEST_CASE("a path through a single cell connects its members and extends slightly beyond") {
  Scene scene;
  for (const glm::dvec3 position : {glm::dvec3(0, 0, 0), glm::dvec3(3, 0, 0), glm::dvec3(0, 3, 0)})
    scene.nodes.push_back(nodeAt(position));
  scene.cells.push_back(cellOf({0, 1, 2}, 0.5));
  const auto views = frames(autoPath(scene, 41));
  CHECK(glm::distance(views.front().camera.pose.position, glm::dvec3(-0.1, -0.1, 0)) < 1e-9);
  CHECK(glm::distance(views.back().camera.pose.position, glm::dvec3(-0.1, 3.2, 0)) < 1e-9);
}

TEST_CASE("the field of view grows with the coverage of the cells") {
  double last = 0;
  for (const double coverage : {0.01, 0.36, 0.49, 1.0}) {
    Scene scene = row(3);
    scene.cells = {cellOf({0, 1}, coverage), cellOf({1, 2}, coverage)};
    const Intrinsics k = frames(autoPath(scene, 2))[0].camera.intrinsics;
    const double share = (0.5 * k.height / k.fy) / std::tan(0.5);
    CHECK(share == Approx(std::clamp(1.1 * std::sqrt(coverage), 0.55, 0.9)));
    CHECK(share > last);
    last = share;
  }
}

TEST_CASE("degenerate scenes give a path or an error, never NaN") {
  CHECK_THROWS_AS(autoPath(Scene{}, 10), Error);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> anywhere(-1, 1);
  std::vector<Scene> scenes{row(1), row(2)};
  Scene same;  // one position, many directions
  for (int i = 0; i < 4; ++i) same.nodes.push_back(nodeAt({1e6, 1, 1}, glm::angleAxis(i * 1.57, glm::dvec3(0, 1, 0))));
  scenes.push_back(same);
  for (int n = 2; n < 12; ++n) {
    Scene scene;
    for (int i = 0; i < n; ++i)
      scene.nodes.push_back(
          nodeAt({anywhere(random), anywhere(random), anywhere(random)},
                 glm::normalize(glm::dquat(anywhere(random), anywhere(random), anywhere(random), anywhere(random)))));
    scenes.push_back(scene);
  }
  for (const Scene& scene : scenes)
    for (const View& view : frames(autoPath(scene, 25))) {
      CHECK(std::isfinite(glm::length(view.camera.pose.position)));
      CHECK(isRotation(view.camera.pose.rotation));
      CHECK(view.camera.intrinsics.fx > 0);
    }
}

TEST_CASE("in scenes of panoramas the path looks ahead, level, with a wide field of view") {
  Scene panoramas = row(4);
  for (Node& node : panoramas.nodes) {
    node.camera.intrinsics = {CameraModel::equirectangular, 1024, 512};
    node.camera.pose.rotation = glm::angleAxis(2.0 * node.camera.pose.position.x, glm::dvec3(0, 1, 0));
  }
  const CameraPath path = autoPath(panoramas, 30);
  CHECK((path.width == 1280 && path.height == 720));
  for (const CameraKey& key : path.keys) {
    CHECK(key.fovY == Approx(1.1));
    const glm::dvec3 ahead = glm::normalize(path.keys.back().position - path.keys.front().position);
    CHECK(glm::dot(key.rotation * glm::dvec3(0, 0, -1), ahead) > 0.999);
    CHECK((key.rotation * glm::dvec3(0, 1, 0)).y > 0.999);
  }
}
