// SPDX-License-Identifier: Apache-2.0
#include "tiny_scene.h"

#include <fmt/format.h>

#include <catch2/catch.hpp>

#include "base/file.h"
#include "io/image_file.h"
#include "lab/generate/synthetic.h"
#include "run_program.h"
#include "support/temporary_folder.h"

namespace fs = std::filesystem;

namespace ibr::test {
namespace {

struct Observation {
  std::size_t image;
  glm::vec2 pixel;
};
struct Point {
  glm::dvec3 position;
  std::vector<Observation> observations;
};

void writeModel(const fs::path& folder, const std::vector<NamedCamera>& cameras, const std::vector<Point>& points) {
  fs::create_directories(folder);
  std::string cameraLines, imageLines, pointLines;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const auto& [name, camera] = cameras[i];
    const Intrinsics& k = camera.intrinsics;
    cameraLines += fmt::format("{} PINHOLE {} {} {} {} {} {}\n", i + 1, k.width, k.height, k.fx, k.fy, k.cx, k.cy);
    // World to camera, axes x right, y down, z forward: half a turn about x relative to ibr's axes.
    const glm::dquat q = glm::dquat(0, 1, 0, 0) * glm::conjugate(camera.pose.rotation);
    const glm::dvec3 t = -(q * camera.pose.position);
    imageLines += fmt::format("{} {} {} {} {} {} {} {} {} {}\n", i + 1, q.w, q.x, q.y, q.z, t.x, t.y, t.z, i + 1, name);
    std::string observations;
    for (std::size_t p = 0; p < points.size(); ++p)
      for (const Observation& seen : points[p].observations)
        if (seen.image == i) observations += fmt::format("{} {} {} ", seen.pixel.x, seen.pixel.y, p + 1);
    imageLines += observations + '\n';
  }
  std::vector<std::size_t> next(cameras.size(), 0);
  for (std::size_t p = 0; p < points.size(); ++p) {
    const Point& point = points[p];
    pointLines +=
        fmt::format("{} {} {} {} 128 128 128 0.5", p + 1, point.position.x, point.position.y, point.position.z);
    for (const Observation& seen : point.observations)
      pointLines += fmt::format(" {} {}", seen.image + 1, next[seen.image]++);
    pointLines += '\n';
  }
  writeFile(folder / "cameras.txt", cameraLines);
  writeFile(folder / "images.txt", imageLines);
  writeFile(folder / "points3D.txt", pointLines);
}

}  // namespace

void writeColmapModel(const fs::path& folder, const std::vector<NamedCamera>& cameras) {
  writeModel(folder, cameras, {});
}

namespace {

const glm::dquat kAhead(1, 0, 0, 0);

SyntheticOptions beforeWall(const std::vector<glm::dvec3>& positions) {
  SyntheticOptions options;
  for (const glm::dvec3& position : positions)
    options.cameras.push_back({pinholeFromFov(192, 144, 0.9), {position, kAhead}});
  options.planes.push_back({.origin = {0, 0, -5}, .extentU = 16, .extentV = 12, .wavelength = 0.25});
  options.planes.push_back({.origin = {0.6, 0.1, -3.5}, .extentU = 1.2, .extentV = 1, .seed = 2, .wavelength = 0.2});
  options.gridStep = 12;
  return options;
}

// Writes photographs and their model. Vertices of the generated scene's cells become the model's tracks.
std::vector<NamedCamera> writePhotographs(const fs::path& folder, const SyntheticScene& made,
                                          const std::vector<std::string>& names) {
  std::vector<NamedCamera> cameras;
  for (std::size_t i = 0; i < names.size(); ++i) {
    cameras.push_back({names[i], made.scene.nodes[i].camera});
    fs::create_directories((folder / names[i]).parent_path());
    writeImage(folder / names[i], made.photographs[i]);
  }
  std::vector<Point> points;
  for (const Cell& cell : made.scene.cells)
    for (std::size_t p = 0; p < cell.mesh.vertexCount(); ++p) {
      points.push_back({vertexPosition(made.scene, cell, p).value(), {}});
      for (std::size_t i = 0; i < cell.members.size(); ++i)
        points.back().observations.push_back({cell.members[i], cell.mesh.match[i][p]});
    }
  writeModel(folder / "sparse", cameras, points);
  return cameras;
}

}  // namespace

TinySet makeTinySet(const fs::path& folder) {
  const SyntheticScene made = makeScene(beforeWall({{0, 0, 0}, {0.5, 0, 0}, {0.2, 0.4, 0}}));
  TinySet set{folder / "photographs", {}, folder / "truth"};
  set.cameras = writePhotographs(set.photographs, made, {"a/0.png", "a/1.png", "b/2.png"});
  const Camera between{set.cameras[0].camera.intrinsics, {glm::dvec3(0.23, 0.13, 0), kAhead}};
  writeColmapModel(set.truth / "sparse", {{"between.png", between}});
  fs::create_directories(set.truth / "images");
  writeImage(set.truth / "images/between.png", renderTruth(made, between));
  return set;
}

std::vector<NamedCamera> makeRow(const fs::path& folder) {
  SyntheticOptions options = beforeWall({{0, 0, 0}, {0.3, 0, 0}, {0.6, 0, 0}, {0.9, 0, 0}, {1.2, 0, 0}});
  options.cells = {{0, 1, 2, 3}, {1, 2, 3, 4}};
  return writePhotographs(folder, makeScene(options), {"row0.png", "row1.png", "row2.png", "row3.png", "row4.png"});
}

const fs::path& tinyFolder() {
  static const TemporaryFolder folder;
  return folder.path();
}

const TinySet& tinySet() {
  static const TinySet set = makeTinySet(tinyFolder());
  return set;
}

const fs::path& tinyScene() {
  static const fs::path scene = [] {
    const fs::path folder = tinyFolder() / "scene";
    const Outcome outcome = runProgram({"build", tinySet().photographs, "-o", folder});
    INFO(outcome.err);
    REQUIRE(outcome.code == 0);
    return folder;
  }();
  return scene;
}

}  // namespace ibr::test
